/* The acquisition loop: one poll() over the streams of a bench, stamps taken right after wake-up,
 * raw bytes to the writer, then into the drivers, decoded samples to the interlock and the caller.
 *
 *     WB_TRY(wb_acquisition_open(&a, &rig, roles, &sink));   ports are open, nothing is sent yet
 *     wb_acquisition_start(a, writer);                       the instruments are greeted
 *     while (wb_acquisition_step(a, timeout) == WB_ACQUISITION_CONTINUE) ...
 *     wb_acquisition_close(a);
 *
 * The stage is stopped from within: a sample that trips the armed interlock has the hold byte
 * written before anything else happens to that sample (but storing its bytes), and the following
 * steps ask for confirmation and send a soft reset when it does not come (daq/acquire/interlock.h).
 * The interlock is armed by wb_acquisition_arm(). Everything is used by one thread.
 */
#ifndef WB_DAQ_ACQUIRE_ACQUISITION_H
#define WB_DAQ_ACQUIRE_ACQUISITION_H

#include <stdbool.h>
#include <stdint.h>

#include "base/reason.h"
#include "daq/acquire/interlock.h"
#include "daq/protocol/diagnosis.h"
#include "daq/protocol/driver.h"
#include "daq/protocol/loss.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"
#include "daq/recording/writer.h"

struct wb_acquisition; /* opaque */

/* Which streams to open: bits `1 << role`. */
#define WB_ACQUISITION_LOAD (1u << WB_ROLE_LOAD)
#define WB_ACQUISITION_MOCAP (1u << WB_ROLE_MOCAP)
#define WB_ACQUISITION_STAGE (1u << WB_ROLE_STAGE)
#define WB_ACQUISITION_ALL (WB_ACQUISITION_LOAD | WB_ACQUISITION_MOCAP | WB_ACQUISITION_STAGE)

enum wb_acquisition_end {
    WB_ACQUISITION_CONTINUE,
    WB_ACQUISITION_DONE,  /* every stream has gone: there is nothing left to wait for */
    WB_ACQUISITION_FAILED /* the loop itself cannot continue; a message was logged */
};

/* Opens the streams of the wanted roles and prepares their drivers; the first that fails ends it,
 * with its own message. `sink` (may be NULL) is copied; it sees every live sample after the
 * interlock did. Nothing is sent to any instrument. */
WB_MUST_CHECK enum wb_status wb_acquisition_open(struct wb_acquisition **out,
                                                 const struct wb_rig *rig, unsigned roles,
                                                 const struct wb_sink *sink);

/* The same for a bench that may not be whole: a stream that cannot be opened is left out (it is not
 * `open` in the latest), and `why` has the reason by role. Fails without memory only. */
WB_MUST_CHECK enum wb_status wb_acquisition_open_each(struct wb_acquisition **out,
                                                      const struct wb_rig *rig, unsigned roles,
                                                      const struct wb_sink *sink,
                                                      struct wb_reason why[WB_INTERLOCK_ROLES]);

/* A second sink, copied, that sees everything after the first one. */
void wb_acquisition_add_sink(struct wb_acquisition *acquisition, const struct wb_sink *sink);

/* Greets the instruments (connect, start to stream); from here on bytes are stored. `writer` is
 * borrowed and may be NULL (nothing is stored). Its recording has the streams declared in the order
 * above. */
void wb_acquisition_start(struct wb_acquisition *acquisition, struct wb_writer *writer);

/* Waits for bytes at most `timeout_ns` (and never longer than 20 ms), and does all that is due. */
enum wb_acquisition_end wb_acquisition_step(struct wb_acquisition *acquisition, int64_t timeout_ns);

/* Says goodbye to the instruments and closes the streams; accepts NULL. It does not stop the stage:
 * every caller has done that before. */
void wb_acquisition_close(struct wb_acquisition *acquisition);

/* --- the stage and its interlock --- */

/* Sets limits and watches them from now on. Silence counts from now. `start_position` (m, machine)
 * is where travel is counted from; NaN takes the last reported position. */
void wb_acquisition_arm(struct wb_acquisition *acquisition,
                        const struct wb_interlock_settings *settings, double start_position);
/* Limits trip no longer; silences are still noted. */
void wb_acquisition_disarm(struct wb_acquisition *acquisition);
/* Force subtracted before it is compared with the force limit, N. */
void wb_acquisition_set_tare(struct wb_acquisition *acquisition, double tare);
const struct wb_interlock *wb_acquisition_interlock(const struct wb_acquisition *acquisition);

/* Sends a command. WB_ERR_BUSY (without a message) while an earlier line is not answered yet; once
 * the interlock has tripped all but STATUS is refused with WB_ERR_ARGUMENT. */
WB_MUST_CHECK enum wb_status wb_acquisition_command(struct wb_acquisition *acquisition,
                                                    enum wb_stage_command command, double distance,
                                                    double speed);

/* The caller saw the last motion end where it should: there is nothing to hold any more. */
void wb_acquisition_motion_ended(struct wb_acquisition *acquisition);
/* A motion command was sent and its end not seen. */
bool wb_acquisition_moving(const struct wb_acquisition *acquisition);

/* Stops the stage now, for a reason of the caller's: trips the interlock, writes the hold byte if a
 * motion may be under way. The following steps complete the stop. */
void wb_acquisition_stop(struct wb_acquisition *acquisition, enum wb_interlock_reason reason,
                         const char *text);
/* How far the stop has come. */
const struct wb_stop *wb_acquisition_stop_state(const struct wb_acquisition *acquisition);

/* --- the latest, for live lines and sequences --- */

struct wb_acquisition_stream_state {
    bool open, gone;  /* gone: the device is not there; a load cell's is looked for again */
    bool ready, lost; /* lost: silent for longer than the interlock allows */
    double rate;      /* valid samples/s, smoothed over about a second */
    uint64_t samples; /* decoded, valid or not */
    uint64_t chunks, bytes;
    struct wb_diagnosis heard;  /* its first bytes, for what to say when nothing is understood */
    uint64_t drops;             /* reads lost by the writer, and datagrams lost in the kernel */
    struct wb_loss_counts loss; /* samples that the instrument sent and that never came */
    bool is_losing;             /* and they are more than chance */
    const char *caution;        /* see wb_stream_caution(); "" or, of no stream, NULL */
};

struct wb_acquisition_latest {
    enum wb_role source; /* whose bytes were decoded last: a remark in a sink is of this stream */
    struct wb_acquisition_stream_state stream[WB_INTERLOCK_ROLES]; /* by role */
    bool has_load, has_mocap, has_stage;
    struct wb_load_sample load; /* the last valid one */
    bool unit_contradicts;      /* the last reading's unit, valid or not: see sample.h */
    int markers_seen;           /* measured ones in the last frame */
    int64_t mocap_ns;           /* arrival of the last frame */
    struct wb_stage_report stage;
    uint64_t stage_reports;
    bool has_settings;
    struct wb_stage_settings settings; /* of the stage's firmware */
    struct wb_writer_state storage;    /* how far the disk is behind */
    bool is_storage_late;              /* so far that it was told */
    char stage_error[160];             /* last complaint of the stage since the last command; "" */
};

/* Current values; owned by the acquisition, refreshed by each step. */
const struct wb_acquisition_latest *wb_acquisition_latest(const struct wb_acquisition *acquisition);

/* True for a marker that the cameras measured in this frame (not occluded, not filled in). */
bool wb_acquisition_marker_measured(const struct wb_marker *marker);

/* Writes an event into the recording (none: does nothing), stamped now. */
void wb_acquisition_event(struct wb_acquisition *acquisition, const char *kind, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));

/* Asks the system to run this thread, and those it will start, before others: on a machine busy
 * with other work a loop may be kept waiting for a second, and with it the hold byte. The kernel's
 * worker that delivers a terminal's bytes stays at the usual priority: beside four busy processes
 * on two cores it is late by 0.1 s at most while it is woken 200 times a second, and by seconds, at
 * any priority of ours, while it is woken thousands of times. Not everybody is allowed to; then
 * nothing happens. */
void wb_acquisition_raise_priority(void);

/* That clock at the last waking up, less all time in which this loop was kept from running or from
 * waiting for bytes: what deadlines are counted in, or an instrument would be blamed for silence
 * that nobody listened to. */
int64_t wb_acquisition_listened_ns(const struct wb_acquisition *acquisition);

#endif
