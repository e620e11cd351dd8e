/* The interlock: decides from the samples when the stage must stop, and tracks the stop until the
 * stage is confirmed to stand. Only decisions: no ports, clocks or memory; times are arguments.
 *
 * `wb_interlock` watches the force, overload and unit of the load cell, the travel and alarms of
 * the stage, and silent streams; the caller trips it for other reasons (a full disk, Ctrl-C). It
 * trips once; the first reason is kept. `wb_stop` is the sequence of a stop: the hold byte at once,
 * status queries until Hold or Idle is reported, a soft reset after 500 ms without confirmation,
 * and failure if the reset is not confirmed either.
 *
 * The deadlines of a stop are host time, also on a virtual rig with a time scale.
 */
#ifndef WB_DAQ_ACQUIRE_INTERLOCK_H
#define WB_DAQ_ACQUIRE_INTERLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/driver.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"

#define WB_INTERLOCK_ROLES 3
#define WB_INTERLOCK_TEXT 512

/* Longest time from the arrival of the sample that trips the interlock to the hold byte. */
#define WB_STOP_HOLD_NS INT64_C(20000000)
/* Without a report of Hold or Idle this long after the hold byte, a soft reset is sent. */
#define WB_STOP_CONFIRM_NS INT64_C(500000000)
/* Time allowed for a controller to restart after a soft reset. */
#define WB_STOP_RESET_NS INT64_C(2000000000)

enum wb_interlock_reason {
    WB_INTERLOCK_NONE,
    WB_INTERLOCK_FORCE,       /* |reading - tare| exceeds the force limit */
    WB_INTERLOCK_OVERLOAD,    /* the range of the load cell is exceeded */
    WB_INTERLOCK_UNIT,        /* the load cell's unit changed or contradicts the rig file */
    WB_INTERLOCK_TRAVEL,      /* the stage is beyond a travel limit */
    WB_INTERLOCK_ALARM,       /* the stage raised an alarm */
    WB_INTERLOCK_STAGE,       /* the stage did not execute a command */
    WB_INTERLOCK_STREAM_LOST, /* an instrument was silent for too long or was disconnected */
    WB_INTERLOCK_DISK,        /* the recording can no longer be written */
    WB_INTERLOCK_MOTION,      /* stage, cameras and force contradict each other */
    WB_INTERLOCK_DROP,        /* the force dropped during loading */
    WB_INTERLOCK_INTERRUPT    /* Ctrl-C or the operator's stop key */
};

/* Name of a reason: "force", "overload", "stream_lost", ... */
const char *wb_interlock_reason_name(enum wb_interlock_reason reason);

struct wb_interlock_settings {
    double force;          /* N, largest |reading - tare|; 0: not watched */
    double overload;       /* N, largest |reading| including tare; 0: not watched */
    bool overload_allowed; /* an overload reported by the instrument does not trip: a specimen
                              loaded beyond its range is being released */
    bool alarm_allowed;    /* an alarm does not trip: the stage is locked and being homed */
    double travel;         /* m down from the start position; 0: not watched */
    double rise;           /* m up from the start position; 0: not watched */
    int down;              /* sign of the stage's axis when the clamp moves down */
    int64_t stream_lost_ns[WB_INTERLOCK_ROLES]; /* longest silence by role; 0: not watched */
};

/* Fills the settings from the rig. A force limit of 0 means the cell's overload, a travel limit of
 * 0 the stage's travel. The allowed silence is divided by the time scale of a virtual rig; with a
 * time scale above 1 it is at least WB_INTERLOCK_SILENCE_NS. For the stage it is always at least
 * WB_INTERLOCK_STAGE_SILENCE_NS: three periods of its status query, which is sent five times a
 * second. */
void wb_interlock_default_settings(struct wb_interlock_settings *settings,
                                   const struct wb_rig *rig);
#define WB_INTERLOCK_SILENCE_NS INT64_C(250000000)
#define WB_INTERLOCK_STAGE_SILENCE_NS INT64_C(600000000)

struct wb_interlock {
    struct wb_interlock_settings settings;
    double tare;                         /* N, subtracted for the force limit; set by the caller */
    double start_position;               /* m, machine position; NaN: travel is not watched yet */
    int64_t last_ns[WB_INTERLOCK_ROLES]; /* last valid sample of each stream */
    bool lost[WB_INTERLOCK_ROLES];       /* silent for longer than allowed */
    int64_t discounted_ns[WB_INTERLOCK_ROLES]; /* stalls of this computer since the last sample */
    bool armed; /* false: `lost` is still updated, but nothing trips */
    enum wb_interlock_reason reason;
    int64_t t_ns; /* arrival of the sample, or end of the allowed silence, that tripped it */
    char text[WB_INTERLOCK_TEXT]; /* for the operator and the recording */
};

/* Initialises, not armed; silence counts from now_ns. */
void wb_interlock_init(struct wb_interlock *interlock, const struct wb_interlock_settings *settings,
                       int64_t now_ns);

/* Process a sample; the bool is true if this call tripped the interlock (frames never trip it). A
 * sample always updates `last_ns` of its stream; limits trip only while armed. An invalid reading
 * does not end a silence unless it is an overload. */
bool wb_interlock_load(struct wb_interlock *interlock, const struct wb_load_sample *sample);
void wb_interlock_mocap(struct wb_interlock *interlock, int64_t t_ns);
bool wb_interlock_stage(struct wb_interlock *interlock, const struct wb_stage_report *report);
/* Checks for silent streams; all samples that arrived before now_ns must have been processed. True
 * if this call tripped the interlock. */
bool wb_interlock_tick(struct wb_interlock *interlock, int64_t now_ns);
/* True if wb_interlock_tick() at now_ns would newly declare this stream lost; the caller should
 * read the stream once more before. */
bool wb_interlock_expires(const struct wb_interlock *interlock, enum wb_role role, int64_t now_ns);
/* Excludes a stall of this computer from the silence of all streams. At most
 * WB_INTERLOCK_DISCOUNTED_NS are excluded between two samples of a stream, so that a lost stream is
 * found even on an overloaded computer. */
void wb_interlock_discount(struct wb_interlock *interlock, int64_t stalled_ns);
#define WB_INTERLOCK_DISCOUNTED_NS INT64_C(5000000000)
/* Trips it for a reason given by the caller, armed or not. False: it has tripped before; the first
 * reason is kept. */
bool wb_interlock_trip(struct wb_interlock *interlock, enum wb_interlock_reason reason,
                       int64_t t_ns, const char *format, ...) __attribute__((format(printf, 4, 5)));

/* When the next allowed silence ends; INT64_MAX: no stream is watched. */
int64_t wb_interlock_deadline(const struct wb_interlock *interlock);

enum wb_stop_state {
    WB_STOP_NONE,      /* not stopping */
    WB_STOP_HOLDING,   /* hold sent, not confirmed yet */
    WB_STOP_RESETTING, /* soft reset sent, not confirmed yet */
    WB_STOP_STANDING,  /* the stage has stopped */
    WB_STOP_FAILED     /* not confirmed: the stage may still be moving */
};

enum wb_stop_action {
    WB_STOP_DO_NOTHING,
    WB_STOP_DO_ASK,  /* send a status query */
    WB_STOP_DO_RESET /* send the soft reset */
};

struct wb_stop {
    enum wb_stop_state state;
    int64_t hold_ns;      /* when the hold byte was sent */
    int64_t reset_ns;     /* when the soft reset was sent; 0: not needed */
    int64_t confirmed_ns; /* arrival of the confirming report */
    int64_t next_ask_ns;
    int idle_reports;
};

/* Begins a stop; the hold byte has just been sent. */
void wb_stop_begin(struct wb_stop *stop, int64_t now_ns);
/* Ends a stop at once: the stage does not move, or cannot be reached. */
void wb_stop_settle(struct wb_stop *stop, enum wb_stop_state state, int64_t now_ns);
/* Processes a report. Hold and Alarm confirm the stop at once; Idle only the second time, because
 * the first report may be older than the hold byte, and a motion sent just before it may still
 * start. */
void wb_stop_report(struct wb_stop *stop, const struct wb_stage_report *report);
/* Returns the action to take now. */
enum wb_stop_action wb_stop_tick(struct wb_stop *stop, int64_t now_ns);
/* When to call wb_stop_tick() next; INT64_MAX once the stop is over. */
int64_t wb_stop_deadline(const struct wb_stop *stop);
/* True in WB_STOP_STANDING and WB_STOP_FAILED. */
bool wb_stop_over(const struct wb_stop *stop);

#endif
