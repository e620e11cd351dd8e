#include "fe/rod_fibre.h"

#include <math.h>

enum {
    MOST_ITERATIONS = 60
};

/* See fe/material.c. */
static const double on_surface = 1e-12;

/* Newton's method converges quadratically: after a step of this size (relative) only round-off is
 * left. */
static const double last_step = 1e-9;

/* The return to the surface: what its equation needs, and its solution. */
struct mapping {
    double E, shear3; /* E and 3 G, with K when kinematic */
    double s, t;      /* trial stresses, less back stresses */
    double length;    /* l, increment of equivalent plastic strain */
    double q;         /* at the end of the step */
    double A, B;
};

static double ratio_at(const struct wb_material *m, const struct wb_hardening_table *table,
                       double c)
{
    const double scaled = c / m->yield_stress;
    if (table && wb_hardening_covers(scaled))
        return wb_hardening_lookup(table, scaled);
    return wb_hardening_ratio(m, c);
}

/* E dp/dc, which is E / (E + H') with the slope H' of the law, finite also where H' is not. */
static double share_of_plastic(const struct wb_material *m, double r)
{
    return r / (r + m->hardening_exponent * (1.0 - r));
}

/* (s/A)^2 + 3 (t/B)^2 and its derivative from those of A and B. */
static double surface(const struct mapping *map, double dA, double dB, double *derivative)
{
    const double a = map->s / map->A, b = map->t / map->B;
    *derivative = -2.0 * (a * a * dA / map->A + 3.0 * b * b * dB / map->B);
    return a * a + 3.0 * b * b;
}

static void place_isotropic(const struct wb_material *m, const struct wb_rod_fibre_state *before,
                            double c, double r, struct mapping *map)
{
    map->length = r * c / m->youngs_modulus - before->accumulated;
    map->q = m->yield_stress + (1.0 - r) * c;
    map->A = c + m->yield_stress - m->youngs_modulus * before->accumulated;
    map->B = map->A + (map->shear3 - map->E) * map->length;
}

/* Newton's method for 1/sqrt(surface) = 1, which is nearly linear in c, within a bracket: at c =
 * high the stress would be returned as far as without shear, at c = low not at all. */
static double return_isotropic(const struct wb_material *m, const struct wb_hardening_table *table,
                               const struct wb_rod_fibre_state *before, struct mapping *map)
{
    const double E = m->youngs_modulus;
    const double shift = E * before->accumulated - m->yield_stress;
    double low = before->yield + shift;
    double high = sqrt(map->s * map->s + 3.0 * map->t * map->t) + shift;
    double c = high;
    double r = ratio_at(m, table, c);

    place_isotropic(m, before, c, r, map);
    if (map->t == 0.0)
        return r;
    for (int i = 0; i < MOST_ITERATIONS; i++) {
        double slope;
        const double dB = 1.0 + (map->shear3 - E) * share_of_plastic(m, r) / E;
        const double S = surface(map, 1.0, dB, &slope);
        if (S > 1.0)
            low = c;
        else
            high = c;
        double next = c + 2.0 * (S - S * sqrt(S)) / slope;
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        const double step = next - c;
        c = next;
        r = ratio_at(m, table, c);
        place_isotropic(m, before, c, r, map);
        if (!(fabs(step) > last_step * c))
            break;
    }
    return r;
}

/* 1/sqrt(surface) is concave in the increment, and this start is not beyond the solution: Newton's
 * steps never pass it. */
static void return_kinematic(const struct wb_material *m, struct mapping *map)
{
    const double size = sqrt(map->s * map->s + 3.0 * map->t * map->t);

    map->q = m->yield_stress;
    map->length = (size - map->q) / (map->t == 0.0 ? map->E : map->shear3);
    for (int i = 0;; i++) {
        map->A = map->q + map->E * map->length;
        map->B = map->q + map->shear3 * map->length;
        if (map->t == 0.0 || i == MOST_ITERATIONS)
            return;
        double slope;
        const double S = surface(map, map->E, map->shear3, &slope);
        const double step = 2.0 * (S - S * sqrt(S)) / slope;
        map->length += step;
        if (!(fabs(step) > last_step * map->length)) {
            map->A = map->q + map->E * map->length;
            map->B = map->q + map->shear3 * map->length;
            return;
        }
    }
}

/* Stresses that are returned: what they keep of the elastic moduli where l stays, and what they
 * lose as l changes by (u d(strain) + v d(angle)) / slope. */
struct share {
    double own, loss, slope;
};

static void tangent_of(const struct share *share, const double moduli[2], const double flow[2],
                       struct wb_rod_fibre_response *response)
{
    const double u = flow[0] * moduli[0], v = 3.0 * flow[1] * moduli[1];
    const double loss = share->loss / share->slope;

    response->D11 = share->own * moduli[0] - loss * u * u;
    response->D12 = -loss * u * v;
    response->D22 = share->own * moduli[1] - loss * v * v;
}

static void return_to_surface(const struct wb_material *m, const struct wb_hardening_table *table,
                              const struct wb_rod_fibre_state *was, struct mapping *map,
                              struct share *share, double flow[2])
{
    const double E = m->youngs_modulus;

    if (m->hardening == WB_HARDENING_KINEMATIC_LINEAR) {
        return_kinematic(m, map);
        flow[0] = map->s / map->A;
        flow[1] = map->t / map->B;
        *share = (struct share){
            .own = map->q + m->strength_coefficient * map->length,
            .loss = map->q,
            .slope = flow[0] * flow[0] * map->E / map->A +
                     3.0 * flow[1] * flow[1] * map->shear3 / map->B,
        };
        return;
    }
    /* The slope H' = E (1 - f) / f of the law is multiplied by f throughout. */
    const double f = share_of_plastic(m, return_isotropic(m, table, was, map));
    flow[0] = map->s / map->A;
    flow[1] = map->t / map->B;
    *share = (struct share){
        .own = map->q,
        .loss = f * map->q - map->length * E * (1.0 - f),
        .slope = flow[0] * flow[0] * E / map->A +
                 3.0 * flow[1] * flow[1] * (E * (1.0 - f) + map->shear3 * f) / map->B,
    };
}

void wb_rod_fibre_respond(const struct wb_material *m, const struct wb_hardening_table *table,
                          const double strain[2], const struct wb_rod_fibre_state *before,
                          struct wb_rod_fibre_state *after, struct wb_rod_fibre_response *response)
{
    const double E = m->youngs_modulus, G = wb_rod_fibre_shear_modulus(m);
    const struct wb_rod_fibre_state was = *before;
    const double axial = E * (strain[0] - was.plastic);
    const double shear = G * (strain[1] - was.plastic_shear);

    *after = was;
    *response = (struct wb_rod_fibre_response){axial, shear, E, 0.0, G, false};
    if (m->hardening == WB_HARDENING_NONE_ELASTIC)
        return;
    const double K = m->hardening == WB_HARDENING_KINEMATIC_LINEAR ? m->strength_coefficient : 0.0;
    struct mapping map = {
        .E = E + K,
        .shear3 = 3.0 * G + K,
        .s = axial - K * was.plastic,
        .t = shear - K / 3.0 * was.plastic_shear,
    };
    const double reach = (1.0 + on_surface) * was.yield;
    if (!(map.s * map.s + 3.0 * map.t * map.t > reach * reach))
        return;

    struct share share;
    double flow[2];
    return_to_surface(m, table, &was, &map, &share, flow);
    const double moduli[2] = {E / map.A, G / map.B};
    after->plastic = was.plastic + map.length * flow[0];
    after->plastic_shear = was.plastic_shear + 3.0 * map.length * flow[1];
    after->accumulated = was.accumulated + map.length;
    after->yield = map.q;
    response->yields = true;
    response->axial = map.q * flow[0] + K * after->plastic;
    response->shear = map.q * flow[1] + K / 3.0 * after->plastic_shear;
    tangent_of(&share, moduli, flow, response);
}

double wb_rod_fibre_energy(const struct wb_material *m, const double strain[2],
                           const struct wb_rod_fibre_state *state)
{
    const double axial = strain[0] - state->plastic, shear = strain[1] - state->plastic_shear;
    const double K = m->hardening == WB_HARDENING_KINEMATIC_LINEAR ? m->strength_coefficient : 0.0;
    return 0.5 *
           (m->youngs_modulus * axial * axial + wb_rod_fibre_shear_modulus(m) * shear * shear +
            K * (state->plastic * state->plastic +
                 state->plastic_shear * state->plastic_shear / 3.0));
}
