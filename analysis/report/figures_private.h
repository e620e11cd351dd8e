/* What the files that draw the report's figures share. */
#ifndef WB_ANALYSIS_REPORT_FIGURES_PRIVATE_H
#define WB_ANALYSIS_REPORT_FIGURES_PRIVATE_H

#include "analysis/report/figures.h"

/* Copies in another unit; the deflections of a curve in mm. NULL when out of memory. */
double *wb_figures_scaled(const double *values, int n, double unit);
double *wb_figures_deflections(const struct wb_curve *curve);

/* A line of `values` on the curve's deflections, and the range of its samples. */
void wb_figures_add_curve(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          const double *values, double unit, const struct wb_figure_style *style);
void wb_figures_add_range(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          struct wb_colour colour);

/* Deflection in mm and force in mN; with a scale over F_max on the right when it is given. */
void wb_figures_set_force_axes(struct wb_panel *panel, double max_force);

/* A figure named WIRE-KIND ("all-KIND" for all wires) that says where its data come from. */
WB_MUST_CHECK enum wb_status wb_figures_start(struct wb_figure **figure,
                                              const struct wb_recordings_results *results,
                                              const struct wb_recordings_results_wire *wire,
                                              const char *kind, double width, double height);

/* Adds F_max to the footer, where a scale or an error is a part of it. */
void wb_figures_state_max_force(struct wb_figure *figure,
                                const struct wb_recordings_results *results, double max_force);

/* The test to scale, with the first usable recording's rig and shape; NULL without one. */
WB_MUST_CHECK enum wb_status wb_figures_draw_bench(struct wb_figure **figure,
                                                   const struct wb_recordings_results *results);

/* Measured: need usable recordings only. */
WB_MUST_CHECK enum wb_status wb_figures_draw_cycles(struct wb_figures_wire *figures,
                                                    const struct wb_recordings_results *results,
                                                    const struct wb_recordings_results_wire *wire);
WB_MUST_CHECK enum wb_status wb_figures_draw_shapes(struct wb_figures_wire *figures,
                                                    const struct wb_recordings_results *results,
                                                    const struct wb_recordings_results_wire *wire,
                                                    struct wb_colour colour);

/* Compared: need a calibration, and the one of the validation that. */
WB_MUST_CHECK enum wb_status wb_figures_draw_samples(struct wb_figure **figure,
                                                     const struct wb_recordings_results *results,
                                                     const struct wb_recordings_results_wire *wire,
                                                     struct wb_colour colour);
WB_MUST_CHECK enum wb_status
wb_figures_draw_calibration(struct wb_figure **figure, const struct wb_recordings_results *results,
                            const struct wb_recordings_results_wire *wire, struct wb_colour colour);
WB_MUST_CHECK enum wb_status
wb_figures_draw_validation(struct wb_figure **figure, const struct wb_recordings_results *results,
                           const struct wb_recordings_results_wire *wire, struct wb_colour colour);
WB_MUST_CHECK enum wb_status wb_figures_draw_error(struct wb_figure **figure,
                                                   const struct wb_recordings_results *results,
                                                   const struct wb_recordings_results_wire *wire,
                                                   struct wb_colour colour);
WB_MUST_CHECK enum wb_status
wb_figures_draw_optimiser(struct wb_figure **figure, const struct wb_recordings_results *results,
                          const struct wb_recordings_results_wire *wire, struct wb_colour colour);

/* Markers of one frame, in the order of the dataset. */
#define WB_FIGURES_MARKERS 64
struct wb_figures_frame {
    int n;                                               /* 0: there is none */
    double x[WB_FIGURES_MARKERS], y[WB_FIGURES_MARKERS]; /* mm */
    double deflection, t;                                /* m, s */
};

/* The frame of the first loading that is nearest to a deflection (m). */
void wb_figures_find_frame(const struct wb_dataset *dataset, double deflection,
                           struct wb_figures_frame *frame);

#endif
