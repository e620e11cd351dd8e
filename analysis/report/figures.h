/* The report's figures, after the paper's Figs. 9, 10, 13, 14 and 15. A figure whose data are
 * missing is NULL.
 */
#ifndef WB_ANALYSIS_REPORT_FIGURES_H
#define WB_ANALYSIS_REPORT_FIGURES_H

#include "analysis/plot/figure.h"
#include "analysis/report/bench/recordings_results.h"
#include "base/status.h"

struct wb_figures_wire {
    struct wb_figure *cycles;      /* Fig. 9a: all cycles of the sample with the most */
    struct wb_figure *samples;     /* Fig. 9b: loading of each sample, mean and range */
    struct wb_figure *shapes;      /* Fig. 10: marker shapes in time */
    struct wb_figure *calibration; /* Fig. 13, with shapes in the inset */
    struct wb_figure *validation;  /* Fig. 14, with the linear elastic curve */
    struct wb_figure *error;       /* Fig. 15 */
    struct wb_figure *optimiser;   /* path of the Nelder-Mead search */
    const struct wb_recordings_results_test *cycles_test,
        *shapes_test; /* shown in the first and third */
};

struct wb_figures {
    struct wb_figure *bench;                             /* the test, to scale */
    struct wb_figure *calibration, *validation, *errors; /* all wires */
    int n_wires;
    struct wb_figures_wire *wires; /* (n_wires), owned */
};

/* Draws all figures that the results give; on a failure nothing needs a release. */
WB_MUST_CHECK enum wb_status wb_figures_create(struct wb_figures *figures,
                                               const struct wb_recordings_results *results);
void wb_figures_release(struct wb_figures *figures); /* accepts a zeroed one */

/* All figures there are, in the report's order, into `list`; returns how many. `list` NULL only
 * counts. */
int wb_figures_list(const struct wb_figures *figures, const struct wb_figure **list);

/* "measured (virtual rig)" or "measured", after where the used recordings come from. */
const char *wb_figures_measured(const struct wb_recordings_results *results);

/* Largest deflection of the first loading, m, and when it was reached, s (infinite without one). */
double wb_figures_turn(const struct wb_dataset *dataset, double *t);

/* A wire's name as part of file names, anchors and figure names: other characters become '-'. */
void wb_figures_slug(char slug[64], const char *name);

#endif
