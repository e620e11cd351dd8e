/* What every load-cell driver does with a decoded line: it counts the line, checks its unit, turns
 * it into a sample, and remarks on faults without flooding the recording. */
#ifndef WB_DAQ_LOADCELL_H
#define WB_DAQ_LOADCELL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/loadcell_line.h"
#include "daq/rig.h"
#include "daq/sample.h"

/* Part of a driver's state; zero, but for the copy of the rig. */
struct wb_loadcell {
    struct wb_rig rig;
    uint64_t n_samples; /* delivered: the next sample's index */
    uint64_t n_refused, n_overloads;
    char first_unit[16], last_unit[16]; /* as printed */
    bool overloaded;                    /* the last sample was */
};

/* Delivers what a line says: a value, an overload, or a remark that it was refused. `line` is for
 * the remark. */
void wb_loadcell_deliver(struct wb_loadcell *loadcell, int64_t t_ns,
                         const struct wb_line_reading *reading, const struct wb_line_buffer *line,
                         const struct wb_sink *sink);

/* A printable copy of a line, cut to `size`. Returns `text`. */
char *wb_loadcell_printable(const struct wb_line_buffer *line, char *text, size_t size);

#endif
