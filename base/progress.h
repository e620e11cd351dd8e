/* A status line on a terminal: task, progress, rate and remaining time. No output if stderr is not
 * a terminal. Redrawn at most ten times a second. */
#ifndef WB_BASE_PROGRESS_H
#define WB_BASE_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct wb_progress {
    const char *label, *unit; /* borrowed */
    double total;             /* 0: unknown */
    double begun;             /* amount done before the start */
    int64_t started_ns, drawn_ns;
    bool on_terminal, drawn;
};

/* `unit` is the plural of the counted things ("steps"). */
void wb_progress_start(struct wb_progress *progress, const char *label, const char *unit,
                       double total);

/* For resumed work: `done` was completed earlier and does not count for the rate. Call it right
 * after wb_progress_start(). */
void wb_progress_resume(struct wb_progress *progress, double done);

/* Updates the amount done; `note` (may be NULL) is appended to the line. */
void wb_progress_update(struct wb_progress *progress, double done, const char *note);

/* Clears the line. */
void wb_progress_finish(struct wb_progress *progress);

/* CPU time of the calling thread, s. */
double wb_progress_thread_cpu(void);

#endif
