/* The results of a campaign of bundles: its datasets read, checked and compared with the published
 * curves, and the properties of a 1D beam fitted to each bundle.
 */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_RESULTS_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_RESULTS_H

#include <stdbool.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/report/bundles/bundles.h"
#include "analysis/report/bundles/bundles_run.h"
#include "analysis/report/bundles/bundles_section.h"
#include "analysis/report/kind.h"
#include "analysis/report/verdict.h"
#include "base/text.h"

/* The homogenised beam fitted to a bundle's run with decaying friction. */
struct wb_bundles_fit {
    enum wb_simulation_state state; /* missing: its dataset is */
    struct wb_text problem;
    struct wb_calibrate_result result; /* of a usable one, as all that follows */
    double *force;                     /* N, (curve.n) of the run's curve; owned */
    double rigidity;                   /* N m2: E I over the diameter of the dataset */
};

struct wb_bundles_results {
    struct wb_kind_outcome outcome;
    const struct wb_bundles *campaign; /* borrowed */
    struct wb_bundles_result runs[WB_BUNDLES_RUNS];
    struct wb_bundles_result rods[WB_BUNDLES_BUNDLES];
    struct wb_bundles_fit fits[WB_BUNDLES_BUNDLES];
    struct wb_bundles_section sections[WB_BUNDLES_RUNS]; /* of the bundles' runs */
};

/* Reads and checks the datasets; then compares and fits the usable ones, with progress after each
 * bundle. Errors are kept in the results. */
wb_kind_load wb_bundles_results_load;
wb_kind_compute wb_bundles_results_compute;
wb_kind_release wb_bundles_results_release;

/* Every run, then every bundle's 1D beam; of struct wb_bundles_results. */
wb_simulation_list wb_bundles_results_list;

/* A run's result (index -1: none) that is usable, else NULL. */
const struct wb_bundles_result *wb_bundles_results_usable(const struct wb_bundles_results *results,
                                                          int run);
/* The same of a bundle's run with decaying friction. */
const struct wb_bundles_result *wb_bundles_results_dynamic(const struct wb_bundles_results *results,
                                                           int bundle);
/* RMS of a run from its published curve; NaN without one of them. */
double wb_bundles_results_rms(const struct wb_bundles_results *results, int run);
/* Whether one of a bundle's runs is usable, or one of any bundle of a group. */
bool wb_bundles_results_either(const struct wb_bundles_results *results,
                               const struct wb_bundles_bundle *bundle);
bool wb_bundles_results_any(const struct wb_bundles_results *results,
                            const struct wb_bundles_group *group);
/* The fit of a bundle that is usable, else NULL. */
const struct wb_bundles_fit *wb_bundles_results_fit(const struct wb_bundles_results *results,
                                                    int bundle);

/* The section model of a run (index -1: none) that was computed, else NULL. */
const struct wb_bundles_section *
wb_bundles_results_section(const struct wb_bundles_results *results, int run);

/* CPU seconds of the 1D beam over those of the bundle's run; NaN unless both are used and known. */
double wb_bundles_results_cost(const struct wb_bundles_results *results, int bundle);

/* E I of a beam, N m2. */
double wb_bundles_results_rigidity(double youngs_modulus, double diameter);

enum {
    WB_BUNDLES_VERDICTS = 2 * WB_BUNDLES_BUNDLES + 3
};

/* Verdicts of the campaign's limits on the usable results. Returns their number: of every
 * bundle its RMS and its cost, and of the energies the worst of all runs. */
int wb_bundles_results_judge(const struct wb_bundles_results *results,
                             struct wb_verdict verdicts[WB_BUNDLES_VERDICTS]);

#endif
