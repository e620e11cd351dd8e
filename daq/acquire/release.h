/* Detects a slack strand: the clamp moves up in small steps and rests after each; the readings at
 * the rests show whether the load still falls. Only readings at a standstill are used, so their
 * delay does not matter. Uses no instrument and no clock.
 *
 * A load that no longer falls is not sufficient: if the clamp jams, the wire stays bent and the
 * reading is as level as with a slack strand. Only a reading at the cell's zero distinguishes them.
 *
 *     wb_release_init(&release, &rig, zero);
 *     wb_release_rest(&release, travel, t_ns);             the clamp has stopped at t_ns
 *     wb_release_add(&release, &sample);                   for every reading
 *     switch (wb_release_judge(&release)) ...
 */
#ifndef WB_DAQ_ACQUIRE_RELEASE_H
#define WB_DAQ_ACQUIRE_RELEASE_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"

enum wb_release_verdict {
    WB_RELEASE_LISTEN, /* this rest needs more readings */
    WB_RELEASE_GO_UP,  /* the load may still fall: one more step */
    WB_RELEASE_SLACK,  /* the reading is level at the cell's zero: the specimen is free */
    WB_RELEASE_LEVEL,  /* the reading is level, but the cell's zero is unknown: the strand is slack,
                          or the clamp does not follow the stage */
    WB_RELEASE_STUCK   /* the reading is level far from zero: more steps would not change it */
};

#define WB_RELEASE_LEVEL_WAY 0.75e-3 /* m over which the reading must stay level */
#define WB_RELEASE_STUCK_WAY 5e-3    /* m of level reading far from zero that end a release */
#define WB_RELEASE_RESTS 8           /* rests that are stored */

struct wb_release_group { /* consecutive readings */
    int n;
    double sum, squares; /* N, N2 */
    int64_t first_ns, last_ns;
};

struct wb_release_place { /* result of a rest */
    double travel;        /* m */
    double force;         /* N, mean; NaN: the cell was overloaded */
    double error;         /* N, standard error of the mean */
};

/* All members are private. */
struct wb_release {
    double noise, capacity;      /* N */
    double zero;                 /* N; NaN: unknown */
    int64_t settle_ns, group_ns; /* settling time of the filter; least duration of a group */
    int64_t rest_ns;             /* when the clamp stopped */
    double travel;               /* m, of this rest */
    bool resting;
    int groups; /* full groups of this rest */
    struct wb_release_group now, before;
    struct wb_release_group overloaded; /* overload readings of this rest; only counted */
    int n_places;
    struct wb_release_place places[WB_RELEASE_RESTS]; /* the newest first */
};

/* `zero` (N) is the reading with a slack strand, such as the tare of a recording; NaN: unknown,
 * then the verdict is never WB_RELEASE_SLACK. */
void wb_release_init(struct wb_release *release, const struct wb_rig *rig, double zero);

/* Begins a rest: the clamp stopped at `travel` (m, any origin) at t_ns. */
void wb_release_rest(struct wb_release *release, double travel, int64_t t_ns);

/* Adds a reading. It is ignored unless it was taken during this rest after the filter has settled,
 * and is valid or an overload. An overload means that the strand is not slack. */
void wb_release_add(struct wb_release *release, const struct wb_load_sample *sample);

/* Judges the readings so far. */
enum wb_release_verdict wb_release_judge(const struct wb_release *release);

/* m, length of the next step up. */
double wb_release_step(const struct wb_release *release);

/* N, mean reading of the last completed rest; NaN before the first rest or at an overload. */
double wb_release_force(const struct wb_release *release);

#endif
