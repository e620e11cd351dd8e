/* Runs as a Slurm job array. In the folder of the logs: slurm-N/ with the script and the list of a
 * submission and what Slurm itself says of its tasks, and NAME.slurm, which names the task of a
 * run that has not been collected yet. */
#ifndef WB_ANALYSIS_JOBS_JOBS_SLURM_H
#define WB_ANALYSIS_JOBS_JOBS_SLURM_H

#include "analysis/jobs/jobs_plan.h"

/* Marks as queued what an earlier call gave to Slurm and has not ended. WB_ERR_BUSY when Slurm does
 * not tell. Asks nothing when nothing was given to it. */
WB_MUST_CHECK enum wb_status wb_jobs_slurm_find_queued(struct wb_jobs_plan *plan);

/* Submits what is to do and not queued, waits for all that is, and collects. An interrupt ends the
 * waiting only. */
WB_MUST_CHECK enum wb_status wb_jobs_slurm_run(struct wb_jobs_plan *plan);

#endif
