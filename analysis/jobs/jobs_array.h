/* What a Slurm array is made of: its script, its list of command lines, its command. */
#ifndef WB_ANALYSIS_JOBS_JOBS_ARRAY_H
#define WB_ANALYSIS_JOBS_JOBS_ARRAY_H

#include "analysis/jobs/jobs_plan.h"

/* Makes the next free folder slurm-N (its name into `list`) with array.sh and jobs.txt: a line for
 * every item, in the order of the plan. */
WB_MUST_CHECK enum wb_status wb_jobs_array_write(const struct wb_jobs_plan *plan, char list[32]);

/* Submits those of the items `first` to `first` + `size` - 1 that are to do and not queued, as
 * tasks 1 to `size`, and marks them as queued; nothing when there are none. With options->dry_run
 * only says what the command is. */
WB_MUST_CHECK enum wb_status wb_jobs_array_submit(struct wb_jobs_plan *plan, const char *list,
                                                  int first, int size);

#endif
