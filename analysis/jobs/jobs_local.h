/* Runs on this machine, in worker processes. */
#ifndef WB_ANALYSIS_JOBS_JOBS_LOCAL_H
#define WB_ANALYSIS_JOBS_JOBS_LOCAL_H

#include "analysis/jobs/jobs_plan.h"

/* Runs the items that are to do and not queued in Slurm, and waits. On an interrupt all children
 * are ended and their incomplete outputs removed. */
void wb_jobs_local_run(struct wb_jobs_plan *plan);

#endif
