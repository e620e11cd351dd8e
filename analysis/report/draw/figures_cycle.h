/* Measured and computed tension of specimens that were calibrated on whole cycles. */
#ifndef WB_ANALYSIS_REPORT_DRAW_FIGURES_CYCLE_H
#define WB_ANALYSIS_REPORT_DRAW_FIGURES_CYCLE_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/plot/figure.h"

enum {
    WB_FIGURES_CYCLE_MOST = 3 /* specimens beside each other */
};

/* The points of the loading or the unloading: deflection (mm), measured and computed tension (mN).
 * The columns have room for all points of the specimen. Returns how many there are. */
int wb_figures_cycle_points(const struct wb_cycle_member *member, const struct wb_cycle_fit *fit,
                            bool is_unloading, double *x, double *measured, double *computed);

/* Adds a panel for each of the first WB_FIGURES_CYCLE_MOST specimens, with its own fit of the
 * chosen law; every third point is drawn. */
void wb_figures_cycle_add_panels(struct wb_figure *figure,
                                 const struct wb_cycle_calibration *calibration,
                                 struct wb_colour colour);

#endif
