#include "fe/rod/rod_fibre.h"

#include <math.h>

enum {
    MAX_ITERATIONS = 60
};

/* Relative distance to the yield surface below which a fibre counts as elastic; see
 * fe/solid/solid_point.c. */
static const double on_surface = 1e-12;

/* Newton's method converges quadratically: after a step of this relative size the error is
 * round-off. */
static const double last_step = 1e-7;

void wb_rod_fibre_law_init(struct wb_rod_fibre_law *law, const struct wb_material *material,
                           const struct wb_hardening_table *table)
{
    *law = (struct wb_rod_fibre_law){
        .material = *material,
        .table = table,
        .hardening = wb_hardening_law(material),
        .shear_modulus = wb_material_shear_modulus(material),
        .back = wb_hardening_back_modulus(material),
        .per_E = 1.0 / material->youngs_modulus,
        .per_yield = 1.0 / material->yield_stress,
    };
}

/* The return mapping: the data of its equation, and its solution. */
struct mapping {
    double E, shear3; /* E and 3 G, plus K for kinematic hardening */
    double s, t;      /* trial stresses minus back stresses */
    double length;    /* increment l of equivalent plastic strain */
    double q;         /* at the end of the step */
    double A, B;
};

/* Result of the return mapping: the direction of flow (s, t) / q, and the dependence of stresses on
 * strains. At constant l the stresses keep own / A and own / B of the elastic moduli; they decrease
 * as l changes by (u d(strain) + v d(angle)) / slope. */
struct returned {
    double flow[2], per_A, per_B;
    double own, loss, slope;
};

static inline double ratio_at(const struct wb_rod_fibre_law *law, double c)
{
    const double scaled = c * law->per_yield;
    if (wb_hardening_covers(scaled))
        return wb_hardening_lookup(law->table, scaled);
    return wb_hardening_ratio(&law->material, c);
}

/* E dp/dc = E / (E + H') with the slope H' of the law; finite also where H' is infinite. */
static inline double plastic_fraction(const struct wb_rod_fibre_law *law, double r, double p)
{
    return r / (r + wb_hardening_exponent(&law->material, p) * (1.0 - r));
}

/* Newton step for 1/sqrt((s/A)^2 + 3 (t/B)^2) = 1 from the derivatives of A and B; *S receives the
 * current sum of squares. */
static inline double newton_step(const struct mapping *map, double dA, double dB, double *S)
{
    const double A = 1.0 / map->A, B = 1.0 / map->B;
    const double aa = map->s * A * map->s * A, bb = 3.0 * map->t * B * map->t * B;
    *S = aa + bb;
    return (*S * sqrt(*S) - *S) / (aa * A * dA + bb * B * dB);
}

static inline void place_growing(const struct wb_rod_fibre_law *law, double accumulated, double c,
                                 double r, struct mapping *map)
{
    const double E = law->material.youngs_modulus, yield = law->material.yield_stress;
    map->length = r * c * law->per_E - accumulated;
    map->q = yield + (1.0 - r) * c;
    map->A = c + yield - E * accumulated;
    map->B = map->A + (map->shear3 - E) * map->length;
}

/* Newton's method with a bracket: c = high is the solution without the difference between shear and
 * axial modulus, c = low is no plastic flow. Returns r. */
static double return_growing(const struct wb_rod_fibre_law *law,
                             const struct wb_rod_fibre_state *before, struct mapping *map)
{
    const double E = law->material.youngs_modulus;
    const double shift = E * before->accumulated - law->material.yield_stress;
    double low = before->yield + shift;
    double high =
        (map->t == 0.0 ? fabs(map->s) : sqrt(map->s * map->s + 3.0 * map->t * map->t)) + shift;
    double c = high;
    double r = ratio_at(law, c);

    place_growing(law, before->accumulated, c, r, map);
    if (map->t == 0.0)
        return r;
    const double excess = (map->shear3 - E) * law->per_E;
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        double S;
        double next =
            c +
            newton_step(map, 1.0, 1.0 + excess * plastic_fraction(law, r, r * c * law->per_E), &S);
        if (S > 1.0)
            low = c;
        else
            high = c;
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        const double step = next - c;
        c = next;
        r = ratio_at(law, c);
        place_growing(law, before->accumulated, c, r, map);
        if (!(fabs(step) > last_step * c))
            break;
    }
    return r;
}

static void place_moving(struct mapping *map)
{
    map->A = map->q + map->E * map->length;
    map->B = map->q + map->shear3 * map->length;
}

/* 1/sqrt of the sum is concave in the increment and the initial guess is below the solution, so
 * Newton's steps do not overshoot. */
static void return_moving(const struct wb_rod_fibre_law *law, struct mapping *map)
{
    const double size = sqrt(map->s * map->s + 3.0 * map->t * map->t);

    map->q = law->material.yield_stress;
    map->length = (size - map->q) / (map->t == 0.0 ? map->E : map->shear3);
    place_moving(map);
    for (int i = 0; i < MAX_ITERATIONS && map->t != 0.0; i++) {
        double S;
        const double step = newton_step(map, map->E, map->shear3, &S);
        map->length += step;
        place_moving(map);
        if (!(fabs(step) > last_step * map->length))
            break;
    }
}

static void return_to_surface(const struct wb_rod_fibre_law *law,
                              const struct wb_rod_fibre_state *was, struct mapping *map,
                              struct returned *back)
{
    const double E = law->material.youngs_modulus;
    double r = 0.0;

    if (law->hardening->moves)
        return_moving(law, map);
    else
        r = return_growing(law, was, map);
    back->per_A = 1.0 / map->A;
    back->per_B = 1.0 / map->B;
    back->flow[0] = map->s * back->per_A;
    back->flow[1] = map->t * back->per_B;
    const double aa = back->flow[0] * back->flow[0] * back->per_A;
    const double bb = 3.0 * back->flow[1] * back->flow[1] * back->per_B;
    if (law->hardening->moves) {
        back->own = map->q + law->back * map->length;
        back->loss = map->q;
        back->slope = aa * map->E + bb * map->shear3;
        return;
    }
    /* The slope H' = E (1 - f) / f is infinite for f = 0, so all terms are multiplied by f. */
    const double f = plastic_fraction(law, r, was->accumulated + map->length);
    back->own = map->q;
    back->loss = f * map->q - map->length * E * (1.0 - f);
    back->slope = aa * E + bb * (E * (1.0 - f) + map->shear3 * f);
}

static void tangent_of(const struct wb_rod_fibre_law *law, const struct returned *back,
                       struct wb_rod_fibre_response *response)
{
    const double E = law->material.youngs_modulus * back->per_A;
    const double G = law->shear_modulus * back->per_B;
    const double u = back->flow[0] * E, v = 3.0 * back->flow[1] * G;
    const double loss = back->loss / back->slope;

    response->D11 = back->own * E - loss * u * u;
    response->D12 = -loss * u * v;
    response->D22 = back->own * G - loss * v * v;
}

void wb_rod_fibre_respond(const struct wb_rod_fibre_law *law, const double strain[2],
                          const struct wb_rod_fibre_state *before, struct wb_rod_fibre_state *after,
                          struct wb_rod_fibre_response *response)
{
    const double E = law->material.youngs_modulus, G = law->shear_modulus, K = law->back;
    const struct wb_rod_fibre_state was = *before;
    const double axial = E * (strain[0] - was.plastic);
    const double shear = G * (strain[1] - was.plastic_shear);

    *after = was;
    *response = (struct wb_rod_fibre_response){axial, shear, E, 0.0, G, false};
    if (!law->hardening->yields)
        return;
    struct mapping map = {
        .E = E + K,
        .shear3 = 3.0 * G + K,
        .s = axial - K * was.plastic,
        .t = shear - K / 3.0 * was.plastic_shear,
    };
    const double reach = (1.0 + on_surface) * was.yield;
    if (!(map.s * map.s + 3.0 * map.t * map.t > reach * reach))
        return;

    struct returned back;
    return_to_surface(law, &was, &map, &back);
    after->plastic = was.plastic + map.length * back.flow[0];
    after->plastic_shear = was.plastic_shear + 3.0 * map.length * back.flow[1];
    after->accumulated = was.accumulated + map.length;
    after->yield = map.q;
    response->yields = true;
    response->axial = map.q * back.flow[0] + K * after->plastic;
    response->shear = map.q * back.flow[1] + K / 3.0 * after->plastic_shear;
    tangent_of(law, &back, response);
}
