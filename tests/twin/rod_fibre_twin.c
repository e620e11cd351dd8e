#include "tests/twin/rod_fibre_twin.h"

#include <math.h>

/* Trial stresses, and where an increment of plastic strain returns them to. */
struct mapping {
    double s, t;
    double q, A, B;
};

static void place(const struct wb_material *m, double G, double accumulated, double increment,
                  struct mapping *map)
{
    map->q = m->yield_stress +
             m->strength_coefficient * pow(accumulated + increment, m->hardening_exponent);
    map->A = map->q + m->youngs_modulus * increment;
    map->B = map->q + 3.0 * G * increment;
}

static double beyond(const struct mapping *map)
{
    const double s = map->s / map->A, t = map->t / map->B;
    return s * s + 3.0 * t * t - 1.0;
}

/* Between no increment and that which leaves no elastic strain. */
static double find_increment(const struct wb_material *m, double G, double accumulated,
                             struct mapping *map)
{
    double low = 0.0;
    double high = sqrt(map->s * map->s + 3.0 * map->t * map->t) / m->youngs_modulus;
    for (;;) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high))
            break;
        place(m, G, accumulated, middle, map);
        if (beyond(map) > 0.0)
            low = middle;
        else
            high = middle;
    }
    place(m, G, accumulated, high, map);
    return high;
}

void wb_rod_fibre_twin_respond(const struct wb_material *m, const double strain[2],
                               const struct wb_rod_fibre_state *before,
                               struct wb_rod_fibre_state *after,
                               struct wb_rod_fibre_response *response)
{
    const struct wb_rod_fibre_state was = *before;
    const double E = m->youngs_modulus, G = E / 2.0 / (1.0 + m->poissons_ratio);
    struct mapping map = {.s = E * (strain[0] - was.plastic),
                          .t = G * (strain[1] - was.plastic_shear)};

    *after = was;
    *response = (struct wb_rod_fibre_response){map.s, map.t, E, 0.0, G, false};
    if (!(sqrt(map.s * map.s + 3.0 * map.t * map.t) > (1.0 + 1e-12) * was.yield))
        return;

    const double l = find_increment(m, G, was.accumulated, &map), p = was.accumulated + l;
    const double flow = map.s / map.A, shear_flow = map.t / map.B;
    after->plastic += l * flow;
    after->plastic_shear += 3.0 * l * shear_flow;
    after->accumulated = p;
    after->yield = map.q;
    response->yields = true;
    response->axial = map.q * flow;
    response->shear = map.q * shear_flow;

    /* The derivative of the equation for l gives dl, and that the tangent. */
    const double H =
        m->strength_coefficient * m->hardening_exponent * pow(p, m->hardening_exponent - 1.0);
    const double u = flow * E / map.A, v = 3.0 * shear_flow * G / map.B;
    const double slope =
        flow * flow / map.A * (E + H) + 3.0 * shear_flow * shear_flow / map.B * (3.0 * G + H);
    const double loss = (map.q - l * H) / slope;
    response->D11 = map.q * E / map.A - loss * u * u;
    response->D12 = -loss * u * v;
    response->D22 = map.q * G / map.B - loss * v * v;
}
