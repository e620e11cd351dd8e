/* Seeing a strand go slack: the clamp goes up in small steps and rests after each, and the readings
 * at the rests say whether the load still falls. Only readings of a clamp that stands are used, so
 * their delay does not matter. Knows no instrument and no clock.
 *
 * A load that no longer falls is not enough: a clamp that jams leaves the wire bent, and the
 * reading as level as a slack strand does. Only a reading at the cell's zero tells the two apart.
 *
 *     wb_release_init(&release, &rig, zero);
 *     wb_release_rest(&release, travel, t_ns);             the clamp stands since then
 *     wb_release_add(&release, &sample);                   every reading
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
    WB_RELEASE_GO_UP,  /* the load may still fall: one step further */
    WB_RELEASE_SLACK,  /* the reading stays level at the cell's zero: the specimen is free */
    WB_RELEASE_LEVEL,  /* it stays level, and the cell's zero is not known: slack, or a clamp that
                          does not go with the stage */
    WB_RELEASE_STUCK   /* it stays level far from zero: going on would change nothing */
};

#define WB_RELEASE_LEVEL_WAY 0.75e-3 /* m over which the reading must stay level */
#define WB_RELEASE_STUCK_WAY 5e-3    /* m of level reading far from zero that end a release */
#define WB_RELEASE_RESTS 8           /* remembered */

struct wb_release_group { /* readings in a row */
    int n;
    double sum, squares; /* N, N2 */
    int64_t first_ns, last_ns;
};

struct wb_release_place { /* what was read at a rest */
    double travel;        /* m */
    double force;         /* N, mean; NaN: the cell was overloaded */
    double error;         /* N, standard error of the mean */
};

/* All of it is private. */
struct wb_release {
    double noise, capacity;      /* N */
    double zero;                 /* N; NaN: not known */
    int64_t settle_ns, group_ns; /* until the filter follows; a group of readings lasts so long */
    int64_t rest_ns;             /* the clamp stands since */
    double travel;               /* m, of this rest */
    bool resting;
    int groups; /* full ones of this rest */
    struct wb_release_group now, before;
    struct wb_release_group overloaded; /* readings of this rest; only counted */
    int n_places;
    struct wb_release_place places[WB_RELEASE_RESTS]; /* the newest first */
};

/* `zero` (N) is what the cell reads with a slack strand, such as a recording's tare; NaN where that
 * is not known: the verdict is then never WB_RELEASE_SLACK. */
void wb_release_init(struct wb_release *release, const struct wb_rig *rig, double zero);

/* The clamp stands at `travel` (m, any origin) since t_ns. */
void wb_release_rest(struct wb_release *release, double travel, int64_t t_ns);

/* A reading; ignored unless it is of this rest, after the cell's filter, and valid or overload. An
 * overloaded cell means that the strand is not slack: the release goes on upwards. */
void wb_release_add(struct wb_release *release, const struct wb_load_sample *sample);

/* What the readings so far say. */
enum wb_release_verdict wb_release_judge(const struct wb_release *release);

/* m: how far the next step up may go. */
double wb_release_step(const struct wb_release *release);

/* N: the mean at the last finished rest; NaN before the first, or where the cell was overloaded. */
double wb_release_force(const struct wb_release *release);

#endif
