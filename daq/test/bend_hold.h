/* A bend test that its operator holds for a while: the stage comes to a stand, recording and limits
 * go on, and then the test goes on with the way as it was planned. The wire relaxes meanwhile, so
 * each hold is told by two events, from which wb_bend_hold_read() makes it again:
 *
 *     hold_start  {"cycle": 1, "phase": "down", "travel_mm": 20.4, "tension_mN": 41.7}
 *     hold_end    {"lasted_s": 32.1, "tension_mN": 39.9, "how": "resumed"}      or "stopped"
 */
#ifndef WB_DAQ_TEST_BEND_HOLD_H
#define WB_DAQ_TEST_BEND_HOLD_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/acquire/sequence.h"
#include "daq/recording/recording.h"

#define WB_BEND_HOLD_START "hold_start"
#define WB_BEND_HOLD_END "hold_end"
#define WB_BEND_HOLD_PHASE 16 /* bytes */

/* All zero is a test that was not held. */
struct wb_bend_hold {
    int n;         /* holds so far */
    double total;  /* s of host time, of those that have ended */
    bool is_on;    /* one is under way, */
    bool stands;   /* and the stage stands */
    int phase;     /* that is held */
    int64_t at_ns; /* when it was asked for */
};

/* Brakes the stage where it is, and enters `held`, a phase of the caller's. `name` of the phase
 * that is held, `cycle` and `tension` (N) are for the recording. */
void wb_bend_hold_begin(struct wb_bend_hold *hold, struct wb_sequence *run, int held,
                        const char *name, int cycle, double tension);

/* What is due in the phase `held`: sees the stage come to a stand, and gives up where it does not,
 * or where the hold lasts longer than `most` (s of host time). */
void wb_bend_hold_step(struct wb_bend_hold *hold, struct wb_sequence *run, double most);

/* Ends the hold, for the recording; the caller moves on. `how`: "resumed", "stopped". Does nothing
 * where none is under way. */
void wb_bend_hold_end(struct wb_bend_hold *hold, struct wb_sequence *run, const char *how,
                      double tension);

/* s of host time since the hold was asked for; NaN where none is under way. */
double wb_bend_hold_lasts(const struct wb_bend_hold *hold);

/* A hold as a recording tells it. */
struct wb_bend_hold_recorded {
    int64_t from_ns, to_ns; /* host clock; to_ns INT64_MAX: it did not end */
    int cycle;
    char phase[WB_BEND_HOLD_PHASE]; /* "down", "up", "rest" */
    double travel;                  /* m down from the start; NaN unknown */
    double before, after;           /* N: the strand's tension at both ends; NaN unknown */
};

/* Reads an event hold_start into `told`, which is filled anew, or hold_end into the one that has
 * begun. WB_ERR_DATA, without a message, where the text is none of ours. */
WB_MUST_CHECK enum wb_status wb_bend_hold_read(const struct wb_event *event,
                                               struct wb_bend_hold_recorded *told);

#endif
