/* A status line on a terminal: the task, its progress, the rate and the time left. Silent when
 * stderr is not a terminal. Redrawn at most ten times a second. */
#ifndef WB_BASE_PROGRESS_H
#define WB_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct wb_progress {
    const char *label, *unit; /* borrowed */
    double total;             /* 0: unknown */
    double begun;             /* done before it was started */
    int64_t started_ns, drawn_ns;
    bool on_terminal, drawn;
};

/* `unit` is the plural of what is counted ("steps"). */
void wb_progress_start(struct wb_progress *progress, const char *label, const char *unit,
                       double total);

/* For work that was begun earlier and is resumed: `done` of it was done before, and the rate counts
 * only what follows. To be called right after wb_progress_start(). */
void wb_progress_resume(struct wb_progress *progress, double done);

/* Updates how much is done; `note` (may be NULL) is put at the end of the line. */
void wb_progress_update(struct wb_progress *progress, double done, const char *note);

/* Clears the line. */
void wb_progress_finish(struct wb_progress *progress);

/* CPU time of the calling thread, s. */
double wb_progress_thread_cpu(void);

#endif
