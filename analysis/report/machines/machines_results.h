/* Results of a campaign of testing machines: the imported files, the curve of each test beyond its
 * first contact, and the mean and scatter of each group. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_RESULTS_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_RESULTS_H

#include "analysis/report/machines/machines_cable.h"
#include "analysis/report/machines/machines_fits.h"

struct wb_machines_results {
    struct wb_kind_outcome outcome;
    const struct wb_machines *campaign; /* borrowed */
    bool has_folder; /* false: the environment variable for the data folder is not set */
    struct wb_machines_group_results *groups; /* (n_groups), owned */
    struct wb_machines_cable_results cable;
    struct wb_machines_fits fits;
};

wb_kind_load wb_machines_results_load;
wb_kind_compute wb_machines_results_compute;
wb_kind_release wb_machines_results_release;

#endif
