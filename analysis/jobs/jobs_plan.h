/* The runs of one call of wb_jobs_run(): their inputs, states and messages. Shared by the local
 * runner and the Slurm runner. */
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
    WB_JOBS_PLAN_TODO,    /* not started, or waiting in the queue */
    WB_JOBS_PLAN_RUNNING, /* started */
    WB_JOBS_PLAN_PRESENT, /* the output existed */
    WB_JOBS_PLAN_DONE,    /* made in this call */
    WB_JOBS_PLAN_FAILED
};

struct wb_jobs_plan_item {
    const struct wb_job *job; /* borrowed */
    enum wb_jobs_plan_state state;
    char output[WB_PATH], log[WB_PATH]; /* absolute */
    char partial[WB_PATH]; /* the folder that the run writes, beside its output: OUTPUT.partial */
    bool was_there;        /* an outdated output existed, distinguished from the new one by: */
    dev_t old_device;
    ino_t old_inode;
    pid_t pid;                   /* of a local run */
    int64_t started_ns, took_ns; /* as seen by this process */
    bool queued; /* a task of a Slurm array, which the following members describe: */
    char array[32], cluster[64]; /* its job id ("12"); cluster, "" for the default one */
    char list[32];               /* folder of its script and list ("slurm-1") */
    int task;                    /* its number in the array */
    char ending[64];             /* final state ("TIMEOUT", "" if unknown) */
    int64_t ended_ns;            /* time of the first look after its end; 0: not ended */
    bool seen;                   /* in the last answer of squeue */
};

struct wb_jobs_plan {
    const struct wb_jobs_options *options; /* borrowed */
    struct wb_jobs_plan_item *items;       /* (n) the most costly first; owned */
    int n;
    char folder[WB_PATH], directory[WB_PATH]; /* absolute: of the logs; current folder */
    int cores_per_job;
    bool on_terminal, drawn;
};

/* Checks names, arguments and outputs, sorts, creates the folders, and finds the existing
 * outputs. */
WB_MUST_CHECK enum wb_status wb_jobs_plan_init(struct wb_jobs_plan *plan, const struct wb_job *jobs,
                                               int n, const struct wb_jobs_options *options);
void wb_jobs_plan_release(struct wb_jobs_plan *plan); /* accepts a zeroed one */

/* Number of items in a state. */
int wb_jobs_plan_count(const struct wb_jobs_plan *plan, enum wb_jobs_plan_state state);

/* Whether the output exists and is complete (and is new, if the old one was outdated). */
bool wb_jobs_plan_is_made(const struct wb_jobs_plan_item *item);

/* Whether the output's place is taken by something that is not a dataset and may not be replaced;
 * if so, reports it and marks the run as failed. */
bool wb_jobs_plan_is_blocked(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item);

/* The file that a complete output has. */
const char *wb_jobs_plan_product(const struct wb_jobs_plan_item *item);

/* Whether the folder that the run writes has its product. */
bool wb_jobs_plan_is_partial_whole(const struct wb_jobs_plan_item *item);

/* Removes what an unfinished run left. With `keep_usable`, keeps a curve that was cut short (it has
 * a dataset.json); true if there is one. */
bool wb_jobs_plan_clean(const struct wb_jobs_plan_item *item, bool keep_usable);

/* Gives the finished folder its final name and removes an outdated one. */
WB_MUST_CHECK enum wb_status wb_jobs_plan_accept(const struct wb_jobs_plan_item *item);

/* Marks a run as failed and reports it: `how` ("exit code 1 after 12 s"), with the last lines of
 * its log and, if not NULL, of another file. */
void wb_jobs_plan_fail(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item, const char *how,
                       const char *other_log);

/* The progress line on a terminal: done, running, left, and the remaining time with `at_once` runs
 * at a time; `note` may be NULL. Without a terminal nothing is drawn. */
void wb_jobs_plan_draw(struct wb_jobs_plan *plan, int at_once, const char *note);
void wb_jobs_plan_clear(struct wb_jobs_plan *plan); /* the line; before other messages */

/* "45 s", "12 min", "3 h 05 min". */
void wb_jobs_plan_duration(char text[32], double seconds);

#endif
