/* A long jog as a row of short ones, so that the stage comes to rest by itself when the program
 * that leads it dies, hangs or loses its cable: the firmware never holds more than the way to brake
 * plus that of WB_JOG_FEED_AHEAD. How much it has done is predicted from its last report by its own
 * acceleration; where no report comes, nothing more is sent.
 *
 *     wb_jog_feed_begin(&feed, &jog);
 *     wb_jog_feed_report(&feed, ...);                     every report of the stage
 *     block = wb_jog_feed_next(&feed, now_ns);            0: nothing to send now
 *     wb_jog_feed_sent(&feed, block);
 *     wb_jog_feed_accepted(&feed, now_ns);                its `ok`
 *
 * Knows no protocol and no clock. Lengths are along the way, from where it begins. */
#ifndef WB_DAQ_PROTOCOL_JOG_FEED_H
#define WB_DAQ_PROTOCOL_JOG_FEED_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/motion.h"

/* s: beyond braking, what the firmware may hold at the speed of the jog. Less than that, and the
 * program's stalls and the steps that GRBL has laid down already (50 ms) would slow the stage. */
#define WB_JOG_FEED_AHEAD 0.15

struct wb_jog {
    double distance;             /* m, with sign */
    struct wb_motion_limits top; /* the jog's speed, and the stage's acceleration */
    double rounding;             /* m: standing so far from the end may be rounding to steps */
    double start; /* m: position of the standing stage, in the direction of distance */
};

/* All of it is private. */
struct wb_jog_feed {
    bool active; /* until the stage stands at the end of the way */
    struct wb_jog jog;
    int direction;
    double ahead, least;     /* m: most that the firmware holds, and least of a block */
    int64_t way_um, sent_um; /* whole micrometres, as GRBL takes them */
    int64_t accepted_um;     /* of those sent */
    struct wb_motion motion; /* as predicted, on the host's clock in s */
    bool at_rest;            /* nothing accepted since the stage was seen standing */
    int64_t seen_ns;         /* the prediction begins */
    int idle_reports;        /* in a row while nothing was on its way */
    bool is_lost;            /* a line was not answered: nothing more until the stage stands */
    int64_t resumed_um;      /* where lines were last found missing; -1: never */
};

/* m: how far the stage goes on, at most, after the last line was sent. */
double wb_jog_feed_ahead(const struct wb_motion_limits *top);

void wb_jog_feed_begin(struct wb_jog_feed *feed, const struct wb_jog *jog);

/* A report that arrived at t_ns: position as in wb_jog.start; speed of the stage in m/s, NaN where
 * it is not told; whether it stands idle. `waits`: a line was sent and not yet answered. When the
 * stage stands short of what it accepted, twice, lines were lost: what is missing is sent again. */
void wb_jog_feed_report(struct wb_jog_feed *feed, int64_t t_ns, double position, double speed,
                        bool is_idle, bool waits);

/* m, with the sign of the distance: what to send now, exact in micrometres; 0: nothing. */
double wb_jog_feed_next(const struct wb_jog_feed *feed, int64_t now_ns);

void wb_jog_feed_sent(struct wb_jog_feed *feed, double block);

/* The firmware took all that was sent. */
void wb_jog_feed_accepted(struct wb_jog_feed *feed, int64_t t_ns);

/* A line was not answered in time: whether it was obeyed shows where the stage comes to rest. */
void wb_jog_feed_lose(struct wb_jog_feed *feed);

#endif
