/* Independent jobs in parallel on threads. */
#ifndef WB_BASE_WORKERS_H
#define WB_BASE_WORKERS_H

#include <stdbool.h>

#include "base/status.h"

struct wb_workers {
    int n;         /* jobs */
    int n_threads; /* maximum number, including the calling thread; 0: one per processor */
    enum wb_status (*job)(void *context, int index);
    /* Called after each job with its status, by one thread at a time; return false to start no
     * further jobs. May be NULL. */
    bool (*done)(void *context, int index, enum wb_status status);
    void *context;
};

/* Starts the jobs in the order of their index as threads become free, and returns when all started
 * jobs have ended. A thread that cannot be started is not an error: others do its jobs. If the
 * caller is below wb_memory_try(), so are job and done: a job that runs out of memory returns
 * WB_ERR_MEMORY, and if `done` runs out of memory, no further job starts. Returns the number of
 * completed jobs. */
int wb_workers_run(const struct wb_workers *workers);

#endif
