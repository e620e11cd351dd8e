/* The acquisition loop: one poll() over the streams of a bench. Bytes are stamped when they are
 * read and passed first to the writer, then to the drivers; decoded samples are passed to the
 * interlock, then to the caller.
 *
 *     WB_TRY(wb_acquisition_open(&a, &rig, roles, &sink));   ports are open, nothing is sent yet
 *     wb_acquisition_start(a, writer);                       starts the instruments
 *     while (wb_acquisition_step(a, timeout) == WB_ACQUISITION_CONTINUE) ...
 *     wb_acquisition_close(a);
 *
 * The loop itself stops the stage: when a sample trips the armed interlock, its bytes are stored
 * and the hold byte is sent before the sample is processed further. The following steps request
 * confirmation and send a soft reset if it does not arrive (daq/acquire/interlock.h).
 * wb_acquisition_arm() arms the interlock. All functions must be called by one thread.
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

/* Set of streams to open: bits `1 << role`. */
#define WB_ACQUISITION_LOAD (1u << WB_ROLE_LOAD)
#define WB_ACQUISITION_MOCAP (1u << WB_ROLE_MOCAP)
#define WB_ACQUISITION_STAGE (1u << WB_ROLE_STAGE)
#define WB_ACQUISITION_ALL (WB_ACQUISITION_LOAD | WB_ACQUISITION_MOCAP | WB_ACQUISITION_STAGE)

enum wb_acquisition_end {
    WB_ACQUISITION_CONTINUE,
    WB_ACQUISITION_DONE,  /* all streams are disconnected */
    WB_ACQUISITION_FAILED /* the loop cannot continue; a message was logged */
};

/* Opens the streams of `roles` and initialises their drivers, up to the first failure, whose
 * message is logged. `sink` (may be NULL) is copied; it receives every live sample after the
 * interlock. Nothing is sent to any instrument. */
WB_MUST_CHECK enum wb_status wb_acquisition_open(struct wb_acquisition **out,
                                                 const struct wb_rig *rig, unsigned roles,
                                                 const struct wb_sink *sink);

/* The same for an incomplete bench: streams that cannot be opened are skipped (not `open` in the
 * latest values), with the reason in `why` by role. Fails only if out of memory. */
WB_MUST_CHECK enum wb_status wb_acquisition_open_each(struct wb_acquisition **out,
                                                      const struct wb_rig *rig, unsigned roles,
                                                      const struct wb_sink *sink,
                                                      struct wb_reason why[WB_INTERLOCK_ROLES]);

/* Adds a second sink, which is copied and called after the first one. */
void wb_acquisition_add_sink(struct wb_acquisition *acquisition, const struct wb_sink *sink);

/* Starts the instruments (connects, requests data) and the recording of bytes. `writer` is borrowed
 * and may be NULL (nothing is stored). Its recording must declare the streams in the order load,
 * mocap, stage. */
void wb_acquisition_start(struct wb_acquisition *acquisition, struct wb_writer *writer);

/* Waits for bytes at most `timeout_ns` (and 20 ms), then processes them and sends due commands. */
enum wb_acquisition_end wb_acquisition_step(struct wb_acquisition *acquisition, int64_t timeout_ns);

/* Sends shutdown commands to the instruments and closes the streams; accepts NULL. The caller must
 * have stopped the stage before. */
void wb_acquisition_close(struct wb_acquisition *acquisition);

/* --- the stage and its interlock --- */

/* Arms the interlock with these limits; silence counts from now. Travel is counted from
 * `start_position` (m, machine); NaN: from the last reported position. Does nothing once the
 * interlock has tripped. */
void wb_acquisition_arm(struct wb_acquisition *acquisition,
                        const struct wb_interlock_settings *settings, double start_position);
/* Limits no longer trip; silent streams are still marked as lost. */
void wb_acquisition_disarm(struct wb_acquisition *acquisition);
/* Sets the force (N) that is subtracted from a reading before comparison with the force limit. */
void wb_acquisition_set_tare(struct wb_acquisition *acquisition, double tare);
const struct wb_interlock *wb_acquisition_interlock(const struct wb_acquisition *acquisition);

/* Sends a command. WB_ERR_BUSY (without a message): an earlier command is not answered yet.
 * WB_ERR_ARGUMENT: the interlock has tripped, which rejects every command except STATUS. */
WB_MUST_CHECK enum wb_status wb_acquisition_command(struct wb_acquisition *acquisition,
                                                    enum wb_stage_command command, double distance,
                                                    double speed);

/* The last motion has ended: a stop then sends no hold byte. */
void wb_acquisition_motion_ended(struct wb_acquisition *acquisition);
/* True after a motion command until wb_acquisition_motion_ended() or a confirmed stop. */
bool wb_acquisition_moving(const struct wb_acquisition *acquisition);

/* Stops the stage for a reason given by the caller: trips the interlock and sends the hold byte if
 * the stage may be moving. The following steps complete the stop. */
void wb_acquisition_stop(struct wb_acquisition *acquisition, enum wb_interlock_reason reason,
                         const char *text);
/* State of the stop. */
const struct wb_stop *wb_acquisition_stop_state(const struct wb_acquisition *acquisition);

/* --- latest values, for status lines and sequences --- */

struct wb_acquisition_stream_state {
    bool open, gone;  /* gone: the device was disconnected; reopening is tried for a load cell */
    bool ready, lost; /* lost: disconnected, or silent for longer than the interlock allows */
    double rate;      /* valid samples/s, smoothed over about a second */
    uint64_t samples; /* decoded, valid or not */
    uint64_t chunks, bytes;
    struct wb_diagnosis heard;  /* its first bytes, to find the cause if they cannot be decoded */
    uint64_t drops;             /* reads dropped by the writer, and datagrams by the kernel */
    struct wb_loss_counts loss; /* samples sent but not received */
    bool is_losing;             /* the loss exceeds chance */
    const char *caution;        /* see wb_stream_caution(); NULL if the stream is not open */
};

struct wb_acquisition_latest {
    enum wb_role source; /* stream that is being decoded: the origin of a remark in a sink */
    struct wb_acquisition_stream_state stream[WB_INTERLOCK_ROLES]; /* by role */
    bool has_load, has_mocap, has_stage;
    struct wb_load_sample load; /* the last valid reading */
    bool unit_contradicts;      /* of the last reading, valid or not: see sample.h */
    int markers_seen;           /* measured markers in the last frame */
    struct wb_stage_report stage;
    uint64_t stage_reports;
    bool has_settings;
    struct wb_stage_settings settings; /* of the stage's firmware */
    struct wb_writer_state storage;    /* delay of the disk */
    bool is_storage_late;              /* the disk fails or its delay has been reported */
    char stage_error[160];             /* last error of the stage since the last command; "" */
};

/* The latest values; owned by the acquisition, updated by each step. */
const struct wb_acquisition_latest *wb_acquisition_latest(const struct wb_acquisition *acquisition);

/* True for a marker that the cameras measured in this frame (not occluded, not filled in). */
bool wb_acquisition_marker_measured(const struct wb_marker *marker);

/* Records an event, stamped with the current time; does nothing without a recording. */
void wb_acquisition_event(struct wb_acquisition *acquisition, const char *kind, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));

/* Raises the scheduling priority of this thread and of threads started later: on a busy machine the
 * loop, and thus the hold byte, may otherwise be delayed by a second. The kernel's worker that
 * delivers the bytes of a terminal keeps its usual priority: with four busy processes on two cores
 * it is late by at most 0.1 s when woken 200 times a second, but by seconds when woken thousands of
 * times a second, whatever our priority. Has no effect without the permission to raise priorities.
 */
void wb_acquisition_raise_priority(void);

/* The monotonic clock at the last waking up minus the sum of all stalls of this loop. Timeouts of
 * instruments use it, so that a stall of this computer does not count as silence. */
int64_t wb_acquisition_listened_ns(const struct wb_acquisition *acquisition);

#endif
