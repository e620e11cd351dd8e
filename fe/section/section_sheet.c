#include "fe/section/section_sheet.h"

#include <math.h>

#include "fe/material/hardening.h"

#define WB_LOG_DOMAIN "section"

enum {
    MAX_ITERATIONS = 60
};

static const double round_off = 1e-12; /* relative to the yield stress */

enum wb_status wb_section_sheet_init(struct wb_section_sheet *sheet,
                                     const struct wb_material *material, bool is_tube)
{
    const struct wb_hardening_law *const law = wb_hardening_law(material);
    const double E = material->youngs_modulus, nu = material->poissons_ratio;
    const double G = wb_material_shear_modulus(material), bulk = E / (1.0 - nu);

    if (law->yields && !law->growth)
        return wb_fail(
            WB_ERR_ARGUMENT,
            "tape: kinematic hardening is not supported; expected isotropic or no hardening");
    *sheet = (struct wb_section_sheet){
        .material = material,
        .is_tube = is_tube,
        .grows = law->yields,
        .modulus = {is_tube ? E : bulk, is_tube ? 0.0 : 2.0 * G, G},
        .weight = {is_tube ? 1.0 : 0.25, is_tube ? 0.0 : 0.75, 3.0},
        .c = {is_tube ? E : 0.5 * bulk, 3.0 * G, 3.0 * G},
        .flow_of_no_yield = law->yields ? material->yield_stress : (double)INFINITY,
    };
    return WB_OK;
}

static double mises(const struct wb_section_sheet *sheet, const double t[3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        sum += sheet->weight[k] * t[k] * t[k];
    return sqrt(sum);
}

static double flow_of(const struct wb_section_sheet *sheet, double p)
{
    const struct wb_material *const m = sheet->material;
    return m->yield_stress + (p > 0.0 ? wb_hardening_law(m)->growth(m, p) : 0.0);
}

/* dH/dp; the law's exponent is d(ln H)/d(ln p). */
static double slope_of(const struct wb_section_sheet *sheet, double p, double flow)
{
    const double growth = flow - sheet->material->yield_stress;
    return p > 0.0 ? wb_hardening_exponent(sheet->material, p) * growth / p : 0.0;
}

/* The increment of p: the root of q(g) - flow(p + dp) with g = dp / flow, which decreases with dp.
 * Newton's method with a bracket. *g and *slope belong to the root. */
static double find_increment(const struct wb_section_sheet *sheet, const double trial[3], double p,
                             double guess, double *g, double *slope)
{
    const double least_flow = flow_of(sheet, p);
    double low = 0.0, high = mises(sheet, trial) / fmin(sheet->c[0], sheet->c[2]);
    double at = guess > 0.0 && guess < high
                    ? guess
                    : 0.5 * (mises(sheet, trial) - least_flow) / fmax(sheet->c[0], sheet->c[2]);

    for (int i = 0; i < MAX_ITERATIONS; i++) {
        const double flow = flow_of(sheet, p + at);
        double sum = 0.0, fall = 0.0;
        *slope = slope_of(sheet, p + at, flow);
        *g = at / flow;
        for (int k = 0; k < 3; k++) {
            const double shrink = 1.0 / (1.0 + *g * sheet->c[k]);
            const double part = sheet->weight[k] * trial[k] * trial[k] * shrink * shrink;
            sum += part;
            fall += part * sheet->c[k] * shrink;
        }
        const double q = sqrt(sum), value = q - flow;
        if (fabs(value) <= round_off * sheet->material->yield_stress)
            break;
        *(value > 0.0 ? &low : &high) = at;
        const double dg = (flow - at * *slope) / (flow * flow);
        const double next = at + value / (fall / q * dg + *slope);
        const double last = at;
        at = next > low && next < high ? next : 0.5 * (low + high);
        if (at == last)
            break;
    }
    return at;
}

/* The derivative of the returned t with respect to component k of the trial t, where g changes at
 * the rate `rate`. */
static void derive(const struct wb_section_sheet *sheet, const double t[3], double g, double slope,
                   int k, double rate, double out[3])
{
    double q = 0.0, W = 0.0;
    for (int i = 0; i < 3; i++) {
        const double part = sheet->weight[i] * t[i] * t[i];
        q += part;
        W += part * sheet->c[i] / (1.0 + g * sheet->c[i]);
    }
    const double V = sheet->weight[k] * t[k] * rate / (1.0 + g * sheet->c[k]);
    const double r = 1.0 - slope * g;
    const double dg = V * r / (slope * q + W * r);
    for (int i = 0; i < 3; i++)
        out[i] = ((i == k ? rate : 0.0) - t[i] * sheet->c[i] * dg) / (1.0 + g * sheet->c[i]);
}

/* Stresses from t, and tangent from the derivatives of t with respect to strains. */
static void put_stress(const struct wb_section_sheet *sheet, const double t[3], double stress[3])
{
    stress[0] = sheet->is_tube ? t[0] : 0.5 * (t[0] + t[1]);
    stress[1] = sheet->is_tube ? 0.0 : 0.5 * (t[0] - t[1]);
    stress[2] = t[2];
}

static void find_tangent(const struct wb_section_sheet *sheet, const double t[3], double g,
                         double slope, double tangent[3][3])
{
    double by[3][3]; /* derivative of t with respect to its trial value */

    for (int k = 0; k < 3; k++) {
        if (g > 0.0)
            derive(sheet, t, g, slope, k, sheet->modulus[k], by[k]);
        for (int i = 0; g <= 0.0 && i < 3; i++)
            by[k][i] = i == k ? sheet->modulus[k] : 0.0;
    }
    const double sign[3][3] = {{1.0, sheet->is_tube ? 0.0 : 1.0, 0.0},
                               {sheet->is_tube ? 0.0 : 1.0, sheet->is_tube ? 0.0 : -1.0, 0.0},
                               {0.0, 0.0, 1.0}};
    for (int j = 0; j < 3; j++) {
        double dt[3], column[3];
        for (int i = 0; i < 3; i++)
            dt[i] = sign[j][0] * by[0][i] + sign[j][1] * by[1][i] + sign[j][2] * by[2][i];
        put_stress(sheet, dt, column);
        for (int i = 0; i < 3; i++)
            tangent[i][j] = column[i];
    }
}

void wb_section_sheet_respond(const struct wb_section_sheet *sheet, const double strain[3],
                              const struct wb_section_sheet_state *before,
                              struct wb_section_sheet_state *after,
                              struct wb_section_sheet_response *response)
{
    const double e1 = strain[0] - before->plastic[0];
    const double e2 = sheet->is_tube ? 0.0 : strain[1] - before->plastic[1];
    double t[3] = {sheet->modulus[0] * (e1 + e2), sheet->modulus[1] * (e1 - e2),
                   sheet->modulus[2] * (strain[2] - before->plastic[2])};
    const double guess = after->accumulated - before->accumulated;
    const double q = mises(sheet, t);
    double g = 0.0, slope = 0.0;

    *after = *before;
    if (q > sheet->flow_of_no_yield && q > flow_of(sheet, before->accumulated)) {
        after->accumulated += find_increment(sheet, t, before->accumulated, guess, &g, &slope);
        for (int k = 0; k < 3; k++)
            t[k] /= 1.0 + g * sheet->c[k];
    }
    put_stress(sheet, t, response->stress);
    if (g > 0.0) {
        const double *const s = response->stress;
        after->plastic[0] += g * (s[0] - 0.5 * s[1]);
        after->plastic[1] += g * (s[1] - 0.5 * s[0]);
        after->plastic[2] += g * 3.0 * s[2];
    }
    find_tangent(sheet, t, g, slope, response->tangent);
}
