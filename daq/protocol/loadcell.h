/* Code shared by the load-cell drivers: the incomplete line, polling, and the handling of a decoded
 * line: it is counted, its unit is checked, it becomes a sample, and errors are reported as remarks
 * at a limited rate. */
#ifndef WB_DAQ_PROTOCOL_LOADCELL_H
#define WB_DAQ_PROTOCOL_LOADCELL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/units.h"
#include "daq/protocol/driver.h"
#include "daq/protocol/line_buffer.h"
#include "daq/protocol/loadcell_line.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"

/* The beginning of each driver's state; initially zero except for the copy of the rig. */
struct wb_loadcell {
    struct wb_rig rig;
    struct wb_line_buffer line; /* the line being received */
    bool whole;                 /* a line end was received: the following lines are complete */
    int64_t next_ask_ns;
    uint64_t n_lines;    /* lines received, readings or not */
    uint64_t lines_seen; /* n_lines when the stream was last checked for silence */
    uint64_t n_samples;  /* samples delivered: index of the next sample */
    uint64_t n_refused;
    char first_unit[16], last_unit[16]; /* as printed */
    bool overloaded;                    /* the last sample was an overload */
    bool contradicted;                  /* a contradiction to the rig file's unit was reported */
};

/* `init` and `ready` of the drivers. `state` points to a struct wb_loadcell. */
WB_MUST_CHECK enum wb_status wb_loadcell_init(void *state, const struct wb_rig *rig);
bool wb_loadcell_ready(const void *state);

/* Sends the query when it is due. Queries are multiples of the poll period apart; queries missed in
 * a pause are skipped. */
void wb_loadcell_poll(struct wb_loadcell *loadcell, int64_t now_ns, const char *question,
                      struct wb_outbox *outbox);

/* Requests the stream again after a second without a line, because the instrument may have been
 * switched off and on, or have missed the request. Counts from the first call after next_ask_ns. */
#define WB_LOADCELL_SILENCE_NS (1000 * WB_NS_PER_MS)
void wb_loadcell_keep_streaming(struct wb_loadcell *loadcell, int64_t now_ns, const char *question,
                                struct wb_outbox *outbox);

/* Delivers the decoded line in the buffer: a value, an overload, or a remark that it was rejected.
 */
void wb_loadcell_deliver(struct wb_loadcell *loadcell, int64_t t_ns,
                         const struct wb_line_reading *reading, const struct wb_sink *sink);

#endif
