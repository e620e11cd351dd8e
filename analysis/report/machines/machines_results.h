/* Results of a campaign of testing machines: the imported files, the curve of each test beyond its
 * first contact, and the mean and scatter of each group. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_RESULTS_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_RESULTS_H

#include "analysis/report/kind.h"
#include "analysis/report/machines/machines.h"
#include "analysis/report/machines/machines_cable.h"
#include "analysis/report/machines/machines_fits.h"
#include "analysis/report/machines/machines_test.h"

struct wb_machines_results {
    struct wb_kind_outcome outcome;
    const struct wb_machines *campaign; /* borrowed */
    bool has_folder; /* false: the environment variable for the data folder is not set */
    struct wb_machines_group_results *groups; /* (n_groups), owned */
    struct wb_machines_cable_results cable;
    struct wb_machines_fits fits;
};

/* As wb_kind_load, wb_kind_compute and wb_kind_release. */
enum wb_status wb_machines_results_load(void *results, const void *campaign);
enum wb_status wb_machines_results_compute(void *results, int n_threads, wb_kind_progress *progress,
                                           void *context);
void wb_machines_results_release(void *results);

#endif
