#include "analysis/cards/card_curve.h"

#include <math.h>

#include "analysis/calibration/law/bending.h"

/* Limits of an interval over its value. */
struct ratios {
    double low, high, candidates_low, candidates_high;
};

static struct ratios ratios_of(const struct wb_estimate *e)
{
    const struct ratios ratios = {e->low / e->value, e->high / e->value,
                                  e->candidates_low / e->value, e->candidates_high / e->value};
    return ratios;
}

/* Unlike wb_interpolate(), keeps an infinite bound infinite. */
static double between(double from, double to, double share)
{
    return share <= 0.0 ? from : share >= 1.0 ? to : (1.0 - share) * from + share * to;
}

static struct ratios ratios_at(const struct wb_card_source *source, double curvature)
{
    const struct wb_properties *const p = &source->properties;
    const struct wb_estimate rigidity = wb_card_source_rigidity(source);
    struct ratios before = ratios_of(&rigidity);
    double start = 0.0;
    for (int k = 0; k < p->n_moments; k++) {
        const struct ratios after = ratios_of(&p->moment[k]);
        const double share = (curvature - start) / (p->curvature[k] - start);
        if (share < 1.0) {
            const struct ratios r = {between(before.low, after.low, share),
                                     between(before.high, after.high, share),
                                     between(before.candidates_low, after.candidates_low, share),
                                     between(before.candidates_high, after.candidates_high, share)};
            return r;
        }
        before = after;
        start = p->curvature[k];
    }
    return before;
}

enum wb_status wb_card_curve_init(struct wb_card_curve *curve, const struct wb_card_source *source)
{
    const struct wb_properties *const p = &source->properties;
    const double largest = wb_card_source_curvature(source);
    for (int k = 0; k < WB_CARD_CURVE; k++)
        curve->curvature[k] = largest * (k + 1) / WB_CARD_CURVE;
    WB_TRY(wb_bending_moments(&p->law, p->outer_diameter, WB_CARD_CURVE, curve->curvature,
                              curve->moment));
    for (int k = 0; k < WB_CARD_CURVE; k++) {
        const struct ratios r = ratios_at(source, curve->curvature[k]);
        const double M = curve->moment[k];
        curve->low[k] = M * r.low;
        curve->high[k] = M * r.high;
        curve->candidates_low[k] = M * r.candidates_low;
        curve->candidates_high[k] = M * r.candidates_high;
        curve->secant[k] = M / curve->curvature[k];
    }
    return WB_OK;
}

enum wb_status wb_card_curve_secant(const struct wb_card_source *source, double curvature,
                                    double *secant, double *low, double *high)
{
    const struct wb_properties *const p = &source->properties;
    const struct ratios r = ratios_at(source, curvature);
    double moment;
    *secant = wb_card_source_rigidity(source).value;
    if (curvature > 0.0) {
        WB_TRY(wb_bending_moments(&p->law, p->outer_diameter, 1, &curvature, &moment));
        *secant = moment / curvature;
    }
    *low = r.low * *secant;
    *high = r.high * *secant;
    return WB_OK;
}
