/* What Slurm knows about the tasks of an array: its commands, and what they print.
 *
 * Works without an accounting database: squeue tells about tasks that wait and run and, for some
 * minutes (MinJobAge), about those that ended. Of older ones only their outputs tell. */
#ifndef WB_ANALYSIS_JOBS_JOBS_QUEUE_H
#define WB_ANALYSIS_JOBS_JOBS_QUEUE_H

#include "analysis/jobs/jobs_plan.h"
#include "base/program.h"
#include "base/status.h"

/* How a question about the queue went. */
struct wb_jobs_queue_look {
    bool lost;         /* Slurm did not answer; nothing was changed */
    char problem[200]; /* what its command said then */
    char reason[64];   /* why a task waits that may wait forever; "" */
};

/* Brings the queued items up to date: begun, waiting, ended and how. */
WB_MUST_CHECK enum wb_status wb_jobs_queue_look(struct wb_jobs_plan *plan,
                                                struct wb_jobs_queue_look *look);

/* The task as Slurm names it, "12_3". */
void wb_jobs_queue_task(const struct wb_jobs_plan_item *item, char task[64]);

/* Asks the accounting, if there is any, how a task ended that squeue has forgotten. */
void wb_jobs_queue_ask_ending(struct wb_jobs_plan_item *item);

/* Array indexes that Slurm allows, from 1 to this. */
int wb_jobs_queue_largest_task(void);

#endif
