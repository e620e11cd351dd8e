/* A Slurm job array: its script, its list of command lines, its submission. */
#ifndef WB_ANALYSIS_JOBS_JOBS_ARRAY_H
#define WB_ANALYSIS_JOBS_JOBS_ARRAY_H

#include "analysis/jobs/jobs_plan.h"

/* Submits `items` (n) as tasks 1 to n and marks them as queued, with script and list in the next
 * free folder slurm-N. With options->dry_run only prints the command. */
WB_MUST_CHECK enum wb_status wb_jobs_array_submit(const struct wb_jobs_plan *plan,
                                                  struct wb_jobs_plan_item *const *items, int n);

#endif
