/* What the sequences on the bench have in common (a bend test, the stage moved by hand): one phase
 * follows another, each motion is offered to the stage until it takes it, and every way out stops
 * the stage first.
 */
#ifndef WB_DAQ_ACQUIRE_SEQUENCE_H
#define WB_DAQ_ACQUIRE_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/acquire/acquisition.h"
#include "daq/acquire/speed_watch.h"
#include "daq/protocol/rig.h"

/* The last two phases of every sequence; its own count from 0. */
enum {
    WB_SEQUENCE_STOP = 8, /* the stage is being stopped */
    WB_SEQUENCE_OVER      /* nothing happens any more */
};

enum wb_sequence_end {
    WB_SEQUENCE_RUNNING,
    WB_SEQUENCE_DONE,         /* as asked for */
    WB_SEQUENCE_LIMIT,        /* a limit of the interlock stopped it */
    WB_SEQUENCE_INTERRUPTED,  /* Ctrl-C or the stop key */
    WB_SEQUENCE_STILL_LOADED, /* release: went as far as it may or as helps, the strand is not seen
                                 slack; the stage is idle */
    WB_SEQUENCE_FAILED        /* an instrument did not answer, the start check refused, ... */
};

/* The stage is where it should be within this, m. */
#define WB_SEQUENCE_TOLERANCE (0.05 * WB_MM)

struct wb_sequence {
    struct wb_rig rig;
    struct wb_acquisition *acquisition;
    const char *remedy; /* static text, "" or what helps when the stage takes no command */
    int phase;
    int64_t phase_ns;   /* when the phase began, */
    int64_t heard_ns;   /* and on the clock that stands while nobody listens */
    int64_t allowed_ns; /* for a motion, on that clock */
    uint64_t reports_seen;
    int idle_reports; /* in a row, of this phase */
    /* The command of this phase. */
    enum wb_stage_command command;
    double distance, speed;      /* m, m/s of the host's time */
    struct wb_speed_watch watch; /* of a jog, in m/s of the host's time */
    uint64_t reports_watched;
    bool unsent;           /* the stage has not taken it yet */
    double start_position; /* m, machine; NaN before it is known */
    double target;         /* m travel of the motion under way */
    enum wb_sequence_end end;
    char text[WB_INTERLOCK_TEXT]; /* why it ended */
};

/* m down from the start position, of a machine position. */
double wb_sequence_travel(const struct wb_sequence *sequence, double position);

/* Begins a phase. */
void wb_sequence_enter(struct wb_sequence *sequence, int phase);

/* How long the phase lasts, without the time in which this process was kept from listening: an
 * instrument is not blamed for that. */
int64_t wb_sequence_lasts_ns(const struct wb_sequence *sequence);

/* Says how it ended; the first end stays. */
void wb_sequence_set_end(struct wb_sequence *sequence, enum wb_sequence_end end, const char *format,
                         ...) __attribute__((format(printf, 3, 4)));

/* Ends it as failed (or interrupted): stops the stage if it may be moving. */
void wb_sequence_give_up(struct wb_sequence *sequence, enum wb_interlock_reason reason,
                         const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Begins a phase with a command to the stage; the phase counts from when the stage takes it. */
void wb_sequence_send(struct wb_sequence *sequence, enum wb_stage_command command, double distance,
                      double speed, int phase);

/* The same with a jog to a travel from the start. */
void wb_sequence_jog_to(struct wb_sequence *sequence, double target, double speed, int phase);

/* A jog has arrived: notes its speed as an event. True when it is not the commanded one; `text`
 * then receives "at 0.5 mm/s instead of 1 mm/s". */
bool wb_sequence_note_speed(struct wb_sequence *sequence, char *text, size_t size);

/* Waits for bytes at most timeout_ns, notes a trip of the interlock and an interrupt, and offers
 * the phase's command again. False when there is nothing more to do in this step. A limit that
 * trips counts as a failure unless `started`. */
bool wb_sequence_wait(struct wb_sequence *sequence, int64_t timeout_ns, bool started);

#endif
