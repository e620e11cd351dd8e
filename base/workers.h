/* Jobs that do not depend on each other, side by side on threads. */
#ifndef WB_BASE_WORKERS_H
#define WB_BASE_WORKERS_H

#include <stdbool.h>

#include "base/status.h"

struct wb_workers {
    int n;         /* jobs */
    int n_threads; /* at most, the calling one among them; 0: as many as there are processors */
    enum wb_status (*job)(void *context, int index);
    /* Called after each job with what it returned, by one thread at a time; false: no further job
     * begins. NULL: none. */
    bool (*done)(void *context, int index, enum wb_status status);
    void *context;
};

/* Begins the jobs in the order of their index, as threads become free, and returns when all that
 * began have ended. A thread that cannot be started is no failure: others do its jobs. Where the
 * caller is below wb_memory_try(), so are job and done: a job that finds no memory returns
 * WB_ERR_MEMORY, and where `done` finds none, no further job begins. Returns how many jobs were
 * done. */
int wb_workers_run(const struct wb_workers *workers);

#endif
