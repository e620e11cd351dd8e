/* Executes a long jog as a sequence of short ones, so that the stage stops by itself if this
 * program crashes or hangs or the cable is unplugged: the firmware never holds more than the
 * braking distance plus WB_JOG_FEED_AHEAD. The progress is predicted from the last report with the
 * stage's acceleration; without reports nothing more is sent.
 *
 *     wb_jog_feed_begin(&feed, &jog);
 *     wb_jog_feed_report(&feed, ...);                     for every report of the stage
 *     block = wb_jog_feed_next(&feed, now_ns);            0: nothing to send now
 *     wb_jog_feed_sent(&feed, block);
 *     wb_jog_feed_accepted(&feed, now_ns);                after its `ok`
 *
 * Independent of protocols and clocks. Lengths count from the beginning of the jog. */
#ifndef WB_DAQ_PROTOCOL_JOG_FEED_H
#define WB_DAQ_PROTOCOL_JOG_FEED_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/motion.h"

/* s at the jog's speed: motion that the firmware may hold in addition to the braking distance. With
 * less, stalls of this program and the 50 ms of steps that GRBL has already prepared would slow the
 * stage down. */
#define WB_JOG_FEED_AHEAD 0.15

struct wb_jog {
    double distance;             /* m, with sign */
    struct wb_motion_limits top; /* speed of the jog, acceleration of the stage */
    double rounding;             /* m, tolerance of the end position for rounding to steps */
    double start;                /* m, position at the beginning, in the direction of distance */
};

/* All members are private. */
struct wb_jog_feed {
    bool active; /* until the stage stands at the end of the jog */
    struct wb_jog jog;
    int direction;
    double ahead, least;     /* m, most that the firmware may hold, and shortest block */
    int64_t way_um, sent_um; /* um (the resolution of GRBL): length of the jog, and sent so far */
    int64_t accepted_um;     /* um accepted by the firmware */
    struct wb_motion motion; /* prediction, host time in s */
    bool at_rest;            /* nothing accepted since the stage was seen standing */
    int64_t seen_ns;         /* begin of the prediction */
    int idle_reports;        /* consecutive idle reports while no reply was pending */
    bool is_lost;            /* a line was not answered: send nothing until the stage stands */
    int64_t resumed_um;      /* where lines were last found missing; -1: never */
};

/* m, longest distance that the stage can still travel after the last line was sent. */
double wb_jog_feed_ahead(const struct wb_motion_limits *top);

void wb_jog_feed_begin(struct wb_jog_feed *feed, const struct wb_jog *jog);

/* Adds a report that arrived at t_ns: position as in wb_jog.start; speed in m/s, NaN if it is not
 * reported; whether the stage is idle. `waits`: the reply to a line is pending. If the stage is
 * idle short of the accepted position in two reports, lines were lost, and the rest is sent again.
 */
void wb_jog_feed_report(struct wb_jog_feed *feed, int64_t t_ns, double position, double speed,
                        bool is_idle, bool waits);

/* m, with the sign of the distance: the block to send now, a multiple of 1 um; 0: none. */
double wb_jog_feed_next(const struct wb_jog_feed *feed, int64_t now_ns);

void wb_jog_feed_sent(struct wb_jog_feed *feed, double block);

/* The firmware has accepted all blocks sent so far. */
void wb_jog_feed_accepted(struct wb_jog_feed *feed, int64_t t_ns);

/* A line was not answered in time: the position where the stage stops shows if it was executed. */
void wb_jog_feed_lose(struct wb_jog_feed *feed);

#endif
