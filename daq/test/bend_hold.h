/* Holds in a bending test: at the operator's command the stage stops while recording and limits
 * stay active; later the test resumes the interrupted motion. The wire relaxes during a hold,
 * therefore two events record each hold, and wb_bend_hold_read() reads them:
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

/* State of the current hold and totals; all zero: no hold so far. */
struct wb_bend_hold {
    int n;         /* holds so far */
    double total;  /* s of host time, sum over the holds that have ended */
    bool is_on;    /* a hold is active */
    bool stands;   /* the hold is active and the stage has stopped */
    int phase;     /* the interrupted phase */
    int64_t at_ns; /* time of the command */
};

/* Stops the stage and enters the caller's phase `held`. The `name` of the interrupted phase, the
 * `cycle` and the `tension` (N) are recorded. */
void wb_bend_hold_begin(struct wb_bend_hold *hold, struct wb_sequence *run, int held,
                        const char *name, int cycle, double tension);

/* One step of the phase `held`. Ends the test if the stage does not stop in time, or if the hold
 * lasts longer than `most` (s of host time). */
void wb_bend_hold_step(struct wb_bend_hold *hold, struct wb_sequence *run, double most);

/* Records the end of the hold; the caller starts the next phase. `how`: "resumed" or "stopped".
 * Does nothing without an active hold. */
void wb_bend_hold_end(struct wb_bend_hold *hold, struct wb_sequence *run, const char *how,
                      double tension);

/* s of host time since the command to hold; NaN without an active hold. */
double wb_bend_hold_lasts(const struct wb_bend_hold *hold);

/* A hold as read from a recording. */
struct wb_bend_hold_recorded {
    int64_t from_ns, to_ns; /* host clock; to_ns is INT64_MAX if the hold did not end */
    int cycle;
    char phase[WB_BEND_HOLD_PHASE]; /* "down", "up", "rest" */
    double travel;                  /* m down from the start; NaN: unknown */
    double before, after; /* N, strand tension at begin and end of the hold; NaN: unknown */
};

/* Reads one event: hold_start overwrites `hold`, hold_end completes it. WB_ERR_DATA, without a
 * message, if the event's text is invalid. */
WB_MUST_CHECK enum wb_status wb_bend_hold_read(const struct wb_event *event,
                                               struct wb_bend_hold_recorded *hold);

#endif
