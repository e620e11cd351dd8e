/* What the load-cell drivers share: the bytes of a line on their way, the questions of a polled
 * cell, and what becomes of a decoded line: it is counted, its unit is checked, it turns into a
 * sample, and faults are remarked on without flooding the recording. */
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

/* The beginning of each driver's state; zero, but for the copy of the rig. */
struct wb_loadcell {
    struct wb_rig rig;
    struct wb_line_buffer line; /* that is coming in */
    bool whole;                 /* a line's end has been seen: what follows are whole lines */
    int64_t next_ask_ns;
    uint64_t n_lines;    /* that came, readings or not, */
    uint64_t lines_seen; /* and when the stream was last found to be alive */
    uint64_t n_samples;  /* delivered: the next sample's index */
    uint64_t n_refused, n_overloads;
    char first_unit[16], last_unit[16]; /* as printed */
    bool overloaded;                    /* the last sample was */
    bool contradicted;                  /* the rig file's unit, and that was remarked */
};

/* `init` and `ready` of the drivers. `state` points to a struct wb_loadcell. */
WB_MUST_CHECK enum wb_status wb_loadcell_init(void *state, const struct wb_rig *rig);
bool wb_loadcell_ready(const void *state);

/* Sends the question when it is due. Questions keep to the grid of the rig's poll period, but do
 * not come in a rush after a pause. */
void wb_loadcell_poll(struct wb_loadcell *loadcell, int64_t now_ns, const char *question,
                      struct wb_outbox *outbox);

/* Asks for the stream again after a second without a line: the instrument was switched off and on,
 * or missed the question. Begins to count at the first call after next_ask_ns. */
#define WB_LOADCELL_SILENCE_NS (1000 * WB_NS_PER_MS)
void wb_loadcell_keep_streaming(struct wb_loadcell *loadcell, int64_t now_ns, const char *question,
                                struct wb_outbox *outbox);

/* Delivers what the line in the buffer says: a value, an overload, or a remark that it was
 * refused. */
void wb_loadcell_deliver(struct wb_loadcell *loadcell, int64_t t_ns,
                         const struct wb_line_reading *reading, const struct wb_sink *sink);

/* A printable copy of a line, cut to `size`. Returns `text`. */
char *wb_loadcell_printable(const struct wb_line_buffer *line, char *text, size_t size);

#endif
