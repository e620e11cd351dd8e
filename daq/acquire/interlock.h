/* The interlock: decides from the samples when the stage must stop, and follows the stop until the
 * stage is seen standing. Pure decisions: no port, no clock, no memory; times come in as arguments.
 *
 * Two parts. `wb_interlock` watches: force and overload of the load cell, a change of its unit,
 * travel and alarms of the stage, streams that fall silent, and whatever the caller trips itself (a
 * full disk, Ctrl-C). It trips once; the first reason stays. `wb_stop` is what follows: the hold
 * byte at once, a status question until Hold or Idle is reported, a soft reset when that takes
 * longer than 500 ms, and giving up when even that is not confirmed.
 *
 * The stop's own deadlines are host time on every rig; a virtual rig's time scale does not move
 * them.
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

/* The hold byte leaves this soon after the sample that shows the limit. */
#define WB_STOP_HOLD_NS INT64_C(20000000)
/* Hold or Idle is reported this soon after the hold byte, else a soft reset follows. */
#define WB_STOP_CONFIRM_NS INT64_C(500000000)
/* What a controller may take to come back from a soft reset. */
#define WB_STOP_RESET_NS INT64_C(2000000000)

enum wb_interlock_reason {
    WB_INTERLOCK_NONE,
    WB_INTERLOCK_FORCE,       /* tension beyond the force limit */
    WB_INTERLOCK_OVERLOAD,    /* the cell's own range is exceeded */
    WB_INTERLOCK_UNIT,        /* the cell's unit changed in mid-stream */
    WB_INTERLOCK_TRAVEL,      /* the stage is beyond the travel limit */
    WB_INTERLOCK_ALARM,       /* the stage raised an alarm */
    WB_INTERLOCK_STAGE,       /* the stage does not obey a command */
    WB_INTERLOCK_STREAM_LOST, /* an instrument fell silent for too long or went away */
    WB_INTERLOCK_DISK,        /* the recording can no longer be written */
    WB_INTERLOCK_MOTION,      /* stage, cameras and force do not fit in the first millimetres */
    WB_INTERLOCK_DROP,        /* the force fell while the wire was bent further */
    WB_INTERLOCK_INTERRUPT    /* Ctrl-C or the operator's stop key */
};

/* One lower-case word for a reason: "force", "overload", "stream_lost", ... */
const char *wb_interlock_reason_name(enum wb_interlock_reason reason);

struct wb_interlock_settings {
    double force;    /* N: largest |reading - tare|; 0: not watched */
    double overload; /* N: largest |reading|, tare included; 0: only the instrument's own word */
    bool overload_allowed; /* the instrument's own word is not a limit either: it is loaded beyond
                              its range and about to be freed */
    bool alarm_allowed;    /* the stage is locked and about to be homed */
    double travel;         /* m down from the start position; 0: not watched */
    double rise;           /* m up from the start position; 0: not watched */
    int down;              /* sign of the stage's axis when the clamp goes down */
    int64_t stream_lost_ns[WB_INTERLOCK_ROLES]; /* by role; 0: not watched */
};

/* Fills the settings from the rig: a force limit of 0 means the cell's overload, a travel limit of
 * 0 the stage's travel; silence is divided by the time scale of a virtual rig but never made
 * shorter than `WB_INTERLOCK_SILENCE_NS`, and for the stage, which is asked five times a second,
 * never shorter than three questions. */
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
    int64_t forgiven_ns[WB_INTERLOCK_ROLES]; /* of the silence so far: time nobody listened */
    bool armed; /* false: silence is still noted in `lost`, but nothing trips */
    enum wb_interlock_reason reason;
    int64_t t_ns;      /* arrival of the sample, or expiry of the silence, that tripped it */
    int64_t lasted_ns; /* lost streams: the silence when it tripped */
    char text[WB_INTERLOCK_TEXT]; /* for the operator and the recording */
};

/* Starts to count silence at now_ns; not armed. */
void wb_interlock_init(struct wb_interlock *interlock, const struct wb_interlock_settings *settings,
                       int64_t now_ns);

/* Each that returns a bool returns true when this very call tripped the interlock; a frame trips
 * nothing. Samples always renew their stream's
 * `last_ns`; limits trip only while armed. An invalid reading does not count as a sign of life
 * unless it is an overload. */
bool wb_interlock_load(struct wb_interlock *interlock, const struct wb_load_sample *sample);
void wb_interlock_mocap(struct wb_interlock *interlock, int64_t t_ns);
bool wb_interlock_stage(struct wb_interlock *interlock, const struct wb_stage_report *report);
/* Looks at the silences: all that arrived before now_ns has been handed over. */
bool wb_interlock_tick(struct wb_interlock *interlock, int64_t now_ns);
/* True when the next tick at now_ns would be the first to call this stream lost: the moment to look
 * once more at what waits to be read. */
bool wb_interlock_expires(const struct wb_interlock *interlock, enum wb_role role, int64_t now_ns);
/* Nobody listened or asked for so long: it does not count as silence of any stream. At most
 * WB_INTERLOCK_DISCOUNTED_NS are forgiven between two samples of a stream, so that a stream that is
 * really lost is found on the worst of machines. */
void wb_interlock_discount(struct wb_interlock *interlock, int64_t stalled_ns);
#define WB_INTERLOCK_DISCOUNTED_NS INT64_C(5000000000)
/* Trips it for a reason of the caller's, armed or not. */
bool wb_interlock_trip(struct wb_interlock *interlock, enum wb_interlock_reason reason,
                       int64_t t_ns, const char *text);

/* When the next silence expires; INT64_MAX when none is running. */
int64_t wb_interlock_deadline(const struct wb_interlock *interlock);

enum wb_stop_state {
    WB_STOP_NONE,      /* not stopping */
    WB_STOP_HOLDING,   /* hold sent, not confirmed yet */
    WB_STOP_RESETTING, /* soft reset sent, not confirmed yet */
    WB_STOP_STANDING,  /* the stage stands */
    WB_STOP_FAILED     /* nothing was confirmed: the stage may still be moving */
};

enum wb_stop_action {
    WB_STOP_DO_NOTHING,
    WB_STOP_DO_ASK,  /* ask the stage for a report */
    WB_STOP_DO_RESET /* send the soft reset */
};

struct wb_stop {
    enum wb_stop_state state;
    int64_t hold_ns;      /* when the hold byte left */
    int64_t reset_ns;     /* when the soft reset left; 0: none was needed */
    int64_t confirmed_ns; /* arrival of the report that confirmed it */
    int64_t next_ask_ns;
    int idle_reports;
};

/* The hold byte just left. */
void wb_stop_begin(struct wb_stop *stop, int64_t now_ns);
/* There was nothing to stop, or no stage to send a command to. */
void wb_stop_settle(struct wb_stop *stop, enum wb_stop_state state, int64_t now_ns);
/* Takes a report. Hold and Alarm confirm at once; Idle only the second time, because the first may
 * have been under way before the hold byte, and a line sent just before may still start. */
void wb_stop_report(struct wb_stop *stop, const struct wb_stage_report *report);
/* What to do now. */
enum wb_stop_action wb_stop_tick(struct wb_stop *stop, int64_t now_ns);
/* When to call wb_stop_tick() next; INT64_MAX when it is over. */
int64_t wb_stop_deadline(const struct wb_stop *stop);
/* True in WB_STOP_STANDING and WB_STOP_FAILED. */
bool wb_stop_over(const struct wb_stop *stop);

#endif
