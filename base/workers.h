/* Runs independent jobs in parallel on threads. */
#ifndef WB_BASE_WORKERS_H
#define WB_BASE_WORKERS_H

#include <stdbool.h>

#include "base/status.h"

struct wb_workers {
    int n;         /* jobs */
    int n_threads; /* maximum, including the calling thread; 0: one per processor */
    enum wb_status (*job)(void *context, int index);
    /* Called after each job with its status, by one thread at a time; return false to start no
     * further jobs. May be NULL. */
    bool (*done)(void *context, int index, enum wb_status status);
    void *context;
};

/* Starts the jobs in the order of their index as threads become free, and returns when all started
 * jobs have ended. If a thread cannot be started, the other threads run its jobs. If the caller
 * runs inside wb_memory_try(), each call of `job` and `done` does, too: a job that runs out of
 * memory ends with WB_ERR_MEMORY; if `done` runs out of memory, no further job is started. Returns
 * the number of jobs that ended, with whatever status. */
int wb_workers_run(const struct wb_workers *workers);

#endif
