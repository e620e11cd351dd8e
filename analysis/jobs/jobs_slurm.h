/* Runs as a Slurm job array. The folder of the logs contains slurm-N/ with the script and the list
 * of a submission and Slurm's own output of its tasks, and NAME.slurm, which names the task of a
 * run that has not been collected yet. */
#ifndef WB_ANALYSIS_JOBS_JOBS_SLURM_H
#define WB_ANALYSIS_JOBS_JOBS_SLURM_H

#include "analysis/jobs/jobs_plan.h"

/* Marks the runs of an earlier call that Slurm has not finished as queued. WB_ERR_BUSY if Slurm
 * does not answer. Calls no command of Slurm if nothing was submitted. */
WB_MUST_CHECK enum wb_status wb_jobs_slurm_find_queued(struct wb_jobs_plan *plan);

/* Submits the runs that are to do and not queued, waits for all queued ones, and collects them. An
 * interrupt ends only the waiting. */
WB_MUST_CHECK enum wb_status wb_jobs_slurm_run(struct wb_jobs_plan *plan);

#endif
