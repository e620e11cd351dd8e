#include "tests/twin/bundle_static_sheet.h"

#include <math.h>

enum {
    MOST_ITERATIONS = 100
};

/* Stresses as a, b and s12 of the header. */
struct split {
    double a, b, s;
};

static double flow_of(const struct wb_material *m, double p)
{
    return m->strength_coefficient > 0.0 && p > 0.0
               ? m->yield_stress + m->strength_coefficient * pow(p, m->hardening_exponent)
               : m->yield_stress;
}

static double slope_of(const struct wb_material *m, double p)
{
    const double n = m->hardening_exponent;
    return m->strength_coefficient > 0.0 ? m->strength_coefficient * n * pow(p, n - 1.0) : 0.0;
}

static double mises(const struct split *t)
{
    return sqrt(0.25 * t->a * t->a + 0.75 * t->b * t->b + 3.0 * t->s * t->s);
}

static struct split shrink(const struct split *trial, const double c[2], double g)
{
    const double A = 1.0 + g * c[0], B = 1.0 + g * c[1];
    return (struct split){trial->a / A, trial->b / B, trial->s / B};
}

/* The root of q(g) - flow(p + g q(g)), which falls with g. The slope of the law may be
 * infinite at the onset of yielding. Secants between bounds (Illinois). */
static double find_increment(const struct wb_material *m, const struct split *trial,
                             const double c[2], double p)
{
    double low = 0.0, high = (mises(trial) / flow_of(m, p) - 1.0) / fmin(c[0], c[1]);
    double at_low = mises(trial) - flow_of(m, p);
    const struct split last = shrink(trial, c, high);
    double at_high = mises(&last) - flow_of(m, p + high * mises(&last));
    int side = 0;

    for (int i = 0; i < MOST_ITERATIONS && at_high < 0.0; i++) {
        const double g = (low * at_high - high * at_low) / (at_high - at_low);
        const struct split t = shrink(trial, c, g);
        const double value = mises(&t) - flow_of(m, p + g * mises(&t));
        if (!(fabs(value) > 1e-13 * m->yield_stress))
            return g;
        if (value > 0.0) {
            low = g;
            at_low = value;
            at_high *= side > 0 ? 0.5 : 1.0;
            side = 1;
        } else {
            high = g;
            at_high = value;
            at_low *= side < 0 ? 0.5 : 1.0;
            side = -1;
        }
    }
    return high;
}

/* The derivative of the shrunken stresses by one of the strains: trial stresses change by `d`. */
static struct split derive(const struct split *t, const struct split *d, const double c[2],
                           double g, double slope)
{
    const double A = 1.0 + g * c[0], B = 1.0 + g * c[1], q = mises(t);
    const double V = 0.25 * t->a * d->a / A + (0.75 * t->b * d->b + 3.0 * t->s * d->s) / B;
    const double W =
        0.25 * t->a * t->a * c[0] / A + (0.75 * t->b * t->b + 3.0 * t->s * t->s) * c[1] / B;
    const double r = 1.0 - slope * g;
    const double dg = V * r / (slope * q * q + W * r);
    return (struct split){
        (d->a - t->a * c[0] * dg) / A,
        (d->b - t->b * c[1] * dg) / B,
        (d->s - t->s * c[1] * dg) / B,
    };
}

void wb_bundle_static_sheet_respond(const struct wb_bundle_static_sheet *sheet,
                                    const double strain[3],
                                    const struct wb_bundle_static_sheet_state *before,
                                    struct wb_bundle_static_sheet_state *after,
                                    struct wb_bundle_static_sheet_response *response)
{
    const struct wb_material *m = &sheet->material;
    const double E = m->youngs_modulus, nu = m->poissons_ratio, G = 0.5 * E / (1.0 + nu);
    const double bulk = E / (1.0 - nu), c[2] = {0.5 * bulk, 3.0 * G};
    const double e1 = strain[0] - before->plastic[0], e2 = strain[1] - before->plastic[1];
    const struct split trial = {bulk * (e1 + e2), 2.0 * G * (e1 - e2),
                                G * (strain[2] - before->plastic[2])};
    const struct split unit[3] = {{bulk, 2.0 * G, 0.0}, {bulk, -2.0 * G, 0.0}, {0.0, 0.0, G}};
    struct split stress = trial;
    double g = 0.0, slope = 0.0;

    *after = *before;
    if (m->hardening != WB_HARDENING_NONE_ELASTIC &&
        mises(&trial) > flow_of(m, before->accumulated)) {
        g = find_increment(m, &trial, c, before->accumulated);
        stress = shrink(&trial, c, g);
        after->accumulated += g * mises(&stress);
        after->plastic[0] += g * (0.25 * stress.a + 0.75 * stress.b);
        after->plastic[1] += g * (0.25 * stress.a - 0.75 * stress.b);
        after->plastic[2] += g * 3.0 * stress.s;
        slope = slope_of(m, after->accumulated);
    }
    response->stress[0] = 0.5 * (stress.a + stress.b);
    response->stress[1] = 0.5 * (stress.a - stress.b);
    response->stress[2] = stress.s;
    for (int k = 0; k < 3; k++) {
        const struct split d = g > 0.0 ? derive(&stress, &unit[k], c, g, slope) : unit[k];
        response->tangent[0][k] = 0.5 * (d.a + d.b);
        response->tangent[1][k] = 0.5 * (d.a - d.b);
        response->tangent[2][k] = d.s;
    }
}
