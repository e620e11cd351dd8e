/* State of an array's tasks from Slurm's commands.
 *
 * Works without an accounting database: squeue reports tasks that wait and run and, for some
 * minutes (MinJobAge), tasks that ended. The result of older ones is known only from their
 * outputs. */
#ifndef WB_ANALYSIS_JOBS_JOBS_QUEUE_H
#define WB_ANALYSIS_JOBS_JOBS_QUEUE_H

#include "analysis/jobs/jobs_plan.h"
#include "base/program.h"
#include "base/status.h"

/* Result of a request to the queue. */
struct wb_jobs_queue_look {
    bool lost;         /* Slurm did not answer; no item was changed */
    char problem[200]; /* the message of its command then */
    char reason[64];   /* why a task waits, if it may wait forever; else "" */
};

/* Updates the queued items: started, waiting, ended and with which state. */
WB_MUST_CHECK enum wb_status wb_jobs_queue_look(struct wb_jobs_plan *plan,
                                                struct wb_jobs_queue_look *look);

/* The name of the task in Slurm, "12_3". */
void wb_jobs_queue_task(const struct wb_jobs_plan_item *item, char task[64]);

/* Asks the accounting database, if there is one, for the final state of a task that squeue no
 * longer lists. */
void wb_jobs_queue_ask_ending(struct wb_jobs_plan_item *item);

/* Largest array index that Slurm allows; indexes start at 1. */
int wb_jobs_queue_largest_task(void);

#endif
