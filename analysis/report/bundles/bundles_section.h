/* The section model (fe/section/section_run.h) of a run's bundle, computed by the report itself, in
 * a tenth of a second, and held against the run's explicit curve.
 */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_SECTION_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_SECTION_H

#include <stdbool.h>

#include "analysis/dataset/curve.h"
#include "analysis/report/bundles/bundles.h"
#include "analysis/report/simulation.h"
#include "base/text.h"
#include "fe/section/section_run.h"

struct wb_bundles_section {
    enum wb_simulation_state state; /* not wanted: no bundle of the campaign takes this run */
    struct wb_text problem;         /* why it was not computed */
    /* Of a usable one: */
    struct wb_curve curve;
    double friction; /* mu */
    bool is_mean;    /* of a friction that decays */
    double loosens;  /* m: from here on it is too stiff; NaN: nowhere */
    struct wb_section_run_rigidity rigidity[WB_SECTION_RUN_LENGTHS];
    double rms, largest; /* distance from the explicit curve, over its largest force; NaN: there is
                            none */
};

/* Computes the section model of `run` into a zeroed result, and how far it is from `explicit`
 * (NULL: there is none), on a grid of that step in m. An error is kept in the result. */
void wb_bundles_section_compute(struct wb_bundles_section *section,
                                const struct wb_bundles_run *run, const struct wb_curve *explicit,
                                double step);
void wb_bundles_section_release(struct wb_bundles_section *section); /* accepts a zeroed one */

#endif
