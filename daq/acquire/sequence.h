/* Common part of the sequences on the bench (a bending test, single jobs of the stage): phases
 * follow each other, a motion command is repeated until the stage accepts it, and the stage is
 * stopped however the sequence ends.
 */
#ifndef WB_DAQ_ACQUIRE_SEQUENCE_H
#define WB_DAQ_ACQUIRE_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/acquire/acquisition.h"
#include "daq/acquire/speed_watch.h"
#include "daq/protocol/rig.h"

/* The last two phases of every sequence; its own phases count from 0. */
enum {
    WB_SEQUENCE_STOP = 8, /* the stage is being stopped */
    WB_SEQUENCE_OVER      /* ended */
};

enum wb_sequence_end {
    WB_SEQUENCE_RUNNING,
    WB_SEQUENCE_DONE,         /* completed */
    WB_SEQUENCE_LIMIT,        /* stopped by a limit of the interlock */
    WB_SEQUENCE_INTERRUPTED,  /* Ctrl-C or the stop key */
    WB_SEQUENCE_STILL_LOADED, /* release: the strand was not found slack within the allowed travel,
                                 or further travel is useless; the stage is idle */
    WB_SEQUENCE_FAILED        /* an instrument did not reply, the start check failed, ... */
};

/* Tolerance of the stage's position, m. */
#define WB_SEQUENCE_TOLERANCE (0.05 * WB_MM)

struct wb_sequence {
    struct wb_rig rig;
    struct wb_acquisition *acquisition;
    const char *remedy; /* static text appended to the message that the stage takes no command */
    int phase;
    int64_t phase_ns;    /* begin of the phase, host time */
    int64_t listened_ns; /* the same on the clock of wb_acquisition_listened_ns() */
    int64_t allowed_ns;  /* timeout of the motion, on that clock */
    uint64_t reports_seen;
    int idle_reports; /* consecutive idle reports in this phase */
    /* The command of this phase. */
    enum wb_stage_command command;
    double distance, speed;      /* m, m/s of host time */
    struct wb_speed_watch watch; /* of a jog, m/s of host time */
    uint64_t reports_watched;
    bool unsent;           /* the stage has not accepted the command yet */
    double start_position; /* m, machine; NaN: unknown */
    double target;         /* m, travel at the end of the current motion */
    enum wb_sequence_end end;
    char text[WB_INTERLOCK_TEXT]; /* reason of the end */
};

/* Travel (m down from the start position) at a machine position. */
double wb_sequence_travel(const struct wb_sequence *sequence, double position);

/* Begins a phase. */
void wb_sequence_enter(struct wb_sequence *sequence, int phase);

/* Duration of the phase so far without stalls of this process, for timeouts of instruments. */
int64_t wb_sequence_lasts_ns(const struct wb_sequence *sequence);

/* Sets the end and its reason; later calls have no effect. */
void wb_sequence_set_end(struct wb_sequence *sequence, enum wb_sequence_end end, const char *format,
                         ...) __attribute__((format(printf, 3, 4)));

/* Ends the sequence as failed (or interrupted) and stops the stage if it may be moving. */
void wb_sequence_give_up(struct wb_sequence *sequence, enum wb_interlock_reason reason,
                         const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Begins a phase with a command to the stage; its duration counts from when the command is sent. */
void wb_sequence_send(struct wb_sequence *sequence, enum wb_stage_command command, double distance,
                      double speed, int phase);

/* Begins a phase with a jog to the travel `target` (m from the start), at `speed` (m/s, rig time).
 */
void wb_sequence_jog_to(struct wb_sequence *sequence, double target, double speed, int phase);

/* Records the speed of a completed jog as an event. True if it is not the commanded speed; `text`
 * then holds "at 0.5 mm/s instead of 1 mm/s". */
bool wb_sequence_note_speed(struct wb_sequence *sequence, char *text, size_t size);

/* Waits for bytes at most timeout_ns, handles a tripped interlock and an interrupt, and sends an
 * unsent command again. False: the caller has nothing to do in this step. Unless `started`, a limit
 * ends the sequence as failed. */
bool wb_sequence_wait(struct wb_sequence *sequence, int64_t timeout_ns, bool started);

#endif
