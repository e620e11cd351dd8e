/* Measured forces beside predicted ones, and the error of the prediction. */
#ifndef WB_ANALYSIS_REPORT_DRAW_FIGURES_COMPARED_H
#define WB_ANALYSIS_REPORT_DRAW_FIGURES_COMPARED_H

#include "analysis/plot/figure.h"
#include "analysis/validation/validate.h"

/* Two panels: forces, and the error over the largest force. */
struct wb_figures_compared {
    struct wb_panel *forces, *errors;
    double max_force; /* N */
};

void wb_figures_compared_start(struct wb_figures_compared *to, struct wb_figure *figure,
                               const char *force_label, double max_force);

/* Adds a loading, an unloading or a cycle: `label` of the measured points and of their error,
 * `line` (NULL: none) of the computed forces. Odd ones have rings and dashed lines. x (n) in mm,
 * forces in mN. */
void wb_figures_compared_add(const struct wb_figures_compared *to, const char *label,
                             const char *line, int n, const double *x, const double *measured,
                             const double *computed, struct wb_colour colour, bool is_odd);

/* The first loading and the unloading of a validation, means over the specimens; not of a test with
 * a follower force. */
void wb_figures_compared_prediction(struct wb_figure *figure,
                                    const struct wb_validate_result *result,
                                    struct wb_colour colour);

#endif
