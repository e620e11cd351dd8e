/* Moment over curvature of a wire for cards: the law's first loading, with the band of the
 * calibration.
 *
 * The band has the relative limits of the moments in the properties file: interpolated linearly
 * between two of their curvatures, below the first curvature towards the relative limits of EI at
 * curvature 0, and beyond the last constant.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_CURVE_H
#define WB_ANALYSIS_CARDS_CARD_CURVE_H

#include "analysis/cards/card_source.h"
#include "base/status.h"

enum {
    WB_CARD_CURVE = 40
};

struct wb_card_curve {
    double curvature[WB_CARD_CURVE]; /* 1/m, evenly up to that of wb_card_source_curvature() */
    double moment[WB_CARD_CURVE];    /* N m */
    double low[WB_CARD_CURVE], high[WB_CARD_CURVE]; /* N m, interval of 95 %; NaN: unknown */
    /* N m, over the laws that the data do not exclude; NaN: unknown */
    double candidates_low[WB_CARD_CURVE], candidates_high[WB_CARD_CURVE];
    double secant[WB_CARD_CURVE]; /* moment over curvature, N m2 */
};

/* Fails only if out of memory. */
WB_MUST_CHECK enum wb_status wb_card_curve_init(struct wb_card_curve *curve,
                                                const struct wb_card_source *source);

/* Secant stiffness of the section at a curvature, M / kappa, N m2; at 0 the virgin section's EI as
 * in wb_card_source_rigidity(). *low and *high are its interval of 95 %; NaN: unknown. */
WB_MUST_CHECK enum wb_status wb_card_curve_secant(const struct wb_card_source *source,
                                                  double curvature, double *secant, double *low,
                                                  double *high);

#endif
