/* Runs on this machine: worker processes, as many as cores. */
#ifndef WB_ANALYSIS_JOBS_JOBS_LOCAL_H
#define WB_ANALYSIS_JOBS_JOBS_LOCAL_H

#include "analysis/jobs/jobs_plan.h"

/* Runs what is to do and not queued elsewhere, and waits. On an interrupt all children are ended
 * and what they had begun is removed. */
WB_MUST_CHECK enum wb_status wb_jobs_local_run(struct wb_jobs_plan *plan);

#endif
