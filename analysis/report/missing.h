/* Makes the datasets that a campaign misses, and those that are outdated: on this machine or as a
 * Slurm array (analysis/jobs/jobs.h).
 *
 * Logs and checkpoints lie beside the report's folder, in FOLDER.jobs. A run that was stopped
 * continues from its checkpoint, which fits one program, one model and one command.
 */
#ifndef WB_ANALYSIS_REPORT_MISSING_H
#define WB_ANALYSIS_REPORT_MISSING_H

#include <stdbool.h>

#include "analysis/jobs/jobs.h"
#include "analysis/report/simulation.h"
#include "base/status.h"

struct wb_missing_outcome {
    int n;            /* datasets that were missing or outdated */
    bool interrupted; /* by Ctrl-C */
};

/* Makes them, and waits; `folder` is the report's. A run that fails is named, and is no error. */
WB_MUST_CHECK enum wb_status wb_missing_make(struct wb_missing_outcome *outcome,
                                             wb_simulation_list *list, const void *results,
                                             const char *folder,
                                             const struct wb_jobs_options *options);

/* Removes the checkpoints of datasets that are usable. A changed program or model leaves
 * checkpoints that no run continues from; they stay until their dataset can be used. */
void wb_missing_remove_checkpoints(wb_simulation_list *list, const void *results,
                                   const char *folder);

#endif
