/* Instrument drivers: protocols as state machines over bytes, without ports or clocks.
 *
 * A driver turns received bytes into samples (`receive`), and gives the bytes to send (`start`,
 * `tick`, `command`). It never reads a port or a clock: times come in as arguments, so the same
 * driver decodes live bytes and recorded ones and gives the same samples bit for bit. The core
 * allocates `state_size` zeroed bytes and calls `init` with the instrument's settings. Only
 * `command` (no commands) and `stop` (no shutdown command) may be NULL.
 */
#ifndef WB_DAQ_PROTOCOL_DRIVER_H
#define WB_DAQ_PROTOCOL_DRIVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"

enum wb_role {
    WB_ROLE_LOAD,
    WB_ROLE_MOCAP,
    WB_ROLE_STAGE
};

/* "load", "mocap", "stage". */
const char *wb_role_name(enum wb_role role);

/* Bytes to send, in order. The owner of the stream writes each entry with one wb_stream_write() and
 * then empties the outbox. */
#define WB_OUTBOX_BYTES 2048
#define WB_OUTBOX_ENTRIES 16
struct wb_outbox {
    size_t n_bytes, n_entries;
    size_t ends[WB_OUTBOX_ENTRIES]; /* end offset of each entry */
    uint8_t bytes[WB_OUTBOX_BYTES];
};

/* Appends an entry; false, and nothing is appended, if it does not fit. */
bool wb_outbox_add(struct wb_outbox *outbox, const void *bytes, size_t n);
bool wb_outbox_add_text(struct wb_outbox *outbox, const char *text);
void wb_outbox_clear(struct wb_outbox *outbox);

/* Commands of a stage. */
enum wb_stage_command {
    WB_STAGE_COMMAND_JOG,        /* relative move by `distance` (m, positive: the clamp moves down
                                    and the deflection grows) at `speed` (m/s) */
    WB_STAGE_COMMAND_HOLD,       /* feed hold, a real-time byte */
    WB_STAGE_COMMAND_JOG_CANCEL, /* a real-time byte */
    WB_STAGE_COMMAND_SOFT_RESET, /* a real-time byte */
    WB_STAGE_COMMAND_HOME,
    WB_STAGE_COMMAND_UNLOCK,
    WB_STAGE_COMMAND_STATUS, /* query a report now */
    WB_STAGE_COMMAND_RESUME  /* continue after a hold, a real-time byte */
};

struct wb_driver {
    const char
        *name; /* protocol name in rig files: "generic", "mt-sics", "natnet", "grbl", "tic" */
    enum wb_role role;
    size_t state_size;

    /* Prepares zeroed state for the rig's settings of this role. */
    enum wb_status (*init)(void *state, const struct wb_rig *rig);
    /* Adds the bytes to send once the stream is open (connect, start streaming, wake up). */
    void (*start)(void *state, int64_t now_ns, struct wb_outbox *outbox);
    /* Decodes one read or datagram that arrived at t_ns. Never fails: invalid bytes cause remarks.
     * n = 0: bytes before t_ns are missing; an incomplete line must be discarded, because joined to
     * the following bytes it could form a wrong number. */
    void (*receive)(void *state, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink);
    /* Called at least every 20 ms: polls, keepalives, clock probes, retries of the handshake. */
    void (*tick)(void *state, int64_t now_ns, struct wb_outbox *outbox);
    /* Stage only. WB_ERR_BUSY, without a message: a previous command is not answered yet (real-time
     * bytes are always accepted). */
    enum wb_status (*command)(void *state, enum wb_stage_command command, double distance,
                              double speed, struct wb_outbox *outbox);
    /* True once the instrument has replied and delivers samples. */
    bool (*ready)(const void *state);
    /* Adds the bytes to send before closing (stop streaming, disconnect). */
    void (*stop)(void *state, struct wb_outbox *outbox);
};

/* For drivers: formats a remark and passes it to the sink, if it accepts remarks. */
void wb_driver_remark(const struct wb_sink *sink, enum wb_log_level level, int64_t t_ns,
                      const char *kind, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Copies n bytes as text for a message: other than printable ASCII becomes '?', so that a message
 * has no control sequences. Text that does not fit is cut. Returns `text`. */
char *wb_driver_printable(char *text, size_t size, const void *bytes, size_t n);

/* ns of the host for a period of a rig, whose clocks may run faster. */
int64_t wb_driver_period_ns(const struct wb_rig *rig, int64_t period_ns);

/* True for the 1st, 2nd, 3rd, 10th, 20th, 30th, 100th, ... occurrence: repeated remarks are
 * reported less and less often. */
bool wb_driver_is_report_due(uint64_t n);

#endif
