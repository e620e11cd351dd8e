/* The runs of one call of wb_jobs_run(): what each has to make, what became of it, and the talk
 * about it. Shared by the runner on this machine and the one of Slurm. */
#ifndef WB_ANALYSIS_JOBS_JOBS_PLAN_H
#define WB_ANALYSIS_JOBS_JOBS_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "analysis/jobs/jobs.h"
#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

enum wb_jobs_plan_state {
    WB_JOBS_PLAN_TODO,    /* nobody has begun it, or it waits in the queue */
    WB_JOBS_PLAN_RUNNING, /* has begun */
    WB_JOBS_PLAN_PRESENT, /* the output was there */
    WB_JOBS_PLAN_DONE,    /* made in this call */
    WB_JOBS_PLAN_FAILED
};

struct wb_jobs_plan_item {
    const struct wb_job *job; /* borrowed */
    enum wb_jobs_plan_state state;
    char output[WB_PATH], log[WB_PATH]; /* absolute */
    bool was_there;                     /* an outdated output, distinguished from the new one by: */
    dev_t old_device;
    ino_t old_inode;
    pid_t pid;                   /* of a local run */
    int64_t started_ns, took_ns; /* as seen from here */
    bool queued;                 /* a task of a Slurm array, which the rest describes: */
    char array[32], cluster[64]; /* its job id ("12"); cluster, "" for the usual one */
    char list[32];               /* folder of its script and list ("slurm-1") */
    int task;                    /* its number in the array */
    char ending[64];             /* how it ended ("TIMEOUT", "" when not known) */
    int64_t ended_ns;            /* when that was first seen; 0: it has not */
    bool seen;                   /* in the last answer of squeue */
};

struct wb_jobs_plan {
    const struct wb_jobs_options *options; /* borrowed */
    struct wb_jobs_plan_item *items;       /* (n) the most costly first; owned */
    int n;
    char folder[WB_PATH], directory[WB_PATH]; /* absolute: of the logs; current */
    int cores_per_job;
    bool on_terminal, drawn;
};

/* Checks names, arguments and outputs, sorts, makes the folders and looks which outputs exist. */
WB_MUST_CHECK enum wb_status wb_jobs_plan_init(struct wb_jobs_plan *plan, const struct wb_job *jobs,
                                               int n, const struct wb_jobs_options *options);
void wb_jobs_plan_release(struct wb_jobs_plan *plan); /* accepts a zeroed one */

/* How many are in a state. */
int wb_jobs_plan_count(const struct wb_jobs_plan *plan, enum wb_jobs_plan_state state);

/* Whether the output is there and whole (and a new one where the old was outdated). */
bool wb_jobs_plan_is_made(const struct wb_jobs_plan_item *item);

/* Whether something is in the output's place that is no dataset and may not be replaced: says so
 * and marks the run as failed. */
bool wb_jobs_plan_is_blocked(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item);

/* The folder that a run writes, beside its output: OUTPUT.partial. */
WB_MUST_CHECK enum wb_status wb_jobs_plan_partial(const struct wb_jobs_plan_item *item,
                                                  char path[WB_PATH]);

/* Whether that holds a dataset. */
bool wb_jobs_plan_is_partial_whole(const struct wb_jobs_plan_item *item);

/* Removes what unfinished runs left. Keeps a curve that was cut short (it has a dataset.json) where
 * `keep_usable` is set; true when there is one. */
bool wb_jobs_plan_clean(const struct wb_jobs_plan_item *item, bool keep_usable);

/* Gives the finished folder its final name; what was outdated goes. */
WB_MUST_CHECK enum wb_status wb_jobs_plan_accept(const struct wb_jobs_plan_item *item);

/* Marks a run as failed and says so: `how` ("exit code 1 after 12 s"), with the last lines of its
 * log and, where it is not NULL, of another file. */
void wb_jobs_plan_fail(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item, const char *how,
                       const char *other_log);

/* The live line on a terminal: done, running, left, and the time left if `at_once` runs are made at
 * a time; `note` may be NULL. Without a terminal nothing is drawn. */
void wb_jobs_plan_draw(struct wb_jobs_plan *plan, int at_once, const char *note);
void wb_jobs_plan_clear(struct wb_jobs_plan *plan); /* the line; before other talk */

/* Appends a word so that a shell reads it back as it is. */
void wb_jobs_plan_quote(struct wb_text *text, const char *word);

/* "45 s", "12 min", "3 h 05 min". */
void wb_jobs_plan_duration(char text[32], double seconds);

#endif
