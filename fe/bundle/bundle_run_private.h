/* Shared by bundle_run.c and bundle_run_checkpoint.c: a run under way. */
#ifndef WB_FE_BUNDLE_BUNDLE_RUN_PRIVATE_H
#define WB_FE_BUNDLE_BUNDLE_RUN_PRIVATE_H

#include "base/checkpoint.h"
#include "base/hash.h"
#include "fe/bundle/bundle_run.h"

/* The straight line through forces against the target, of one row. */
struct wb_bundle_run_line {
    double n, x, y, xx, xy, yy;
};

/* s */
struct wb_bundle_run_clock {
    double wall, cpu;
};

struct wb_bundle_run_now {
    struct wb_bundle_history *history;
    const struct wb_bundle_model *model;
    struct wb_bundle_run_options options;
    struct wb_bundle *bundle;
    enum wb_status status;
    struct wb_bundle_run_clock begun, saved; /* clocks of this process */
    double wall_before;                      /* s, in the processes before */
    double cpu_before;
    bool may_resume;
    char program[WB_SHA256_TEXT]; /* this binary's, where there are checkpoints */

    /* From here on all is in a checkpoint (visit_place() in bundle_run_checkpoint.c). */
    struct wb_bundle_state state;
    double from;   /* m: ratios count from here on */
    bool counting; /* the tip was there */
    bool judged;   /* the duration is believed */
    double begin;  /* s of the bundle's time: the loading's */
    double next;   /* s: duration of the next attempt */
    double kinetic, artificial;
    double most_external;

    int branch;      /* ways made so far */
    bool under_way;  /* on another */
    int place;       /* the row that is passed, from 1; 0: the half step before them */
    int looks;       /* the next look in it, from 1 */
    long long left;  /* steps to there; -1: not begun */
    double way[2];   /* m: from, to */
    bool hangs;      /* the strand went slack on this way, the tip rests */
    double way_time; /* s: its begin */
    int block;       /* steps between samples */
    struct wb_bundle_run_line vertical, tension;
    int slack_samples;        /* beside these */
    bool samples_before;      /* the row's place */
    struct wb_bundle_row row; /* passed, its mean not complete */
};

/* Clocks of this process. */
struct wb_bundle_run_clock wb_bundle_run_clock(void);
/* Into the history, what was spent so far. */
void wb_bundle_run_take_time(struct wb_bundle_run_now *r);

/* Saves or restores all but the bundle. Memory of the history stays. */
void wb_bundle_run_visit(struct wb_bundle_run_now *r, struct wb_checkpoint *c);

WB_MUST_CHECK enum wb_status wb_bundle_run_save(struct wb_bundle_run_now *r);

/* Into `c`, which restores then, what an earlier process left; nothing where there is none. */
WB_MUST_CHECK enum wb_status wb_bundle_run_find(struct wb_bundle_run_now *r,
                                                struct wb_checkpoint *c);

/* The bundle, after all else was restored. */
WB_MUST_CHECK enum wb_status wb_bundle_run_resume(struct wb_bundle_run_now *r,
                                                  struct wb_checkpoint *c);

#endif
