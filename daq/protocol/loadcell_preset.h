/* Presets of the generic line protocol: what instruments of known makers need, by a name that the
 * rig file gives (`load_cell.preset`). One row is one instrument's way of speaking; keys that the
 * rig file gives itself go before the row's. How each instrument is connected is in
 * docs/instruments.md.
 *
 * A preset only fills in settings (port, line end, unit, commands) and adds what the settings
 * cannot say: which lines are answers to commands and no readings, and that a line without a unit
 * is an unstable one. The lines themselves are read by daq/protocol/loadcell_line.h.
 */
#ifndef WB_DAQ_PROTOCOL_LOADCELL_PRESET_H
#define WB_DAQ_PROTOCOL_LOADCELL_PRESET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/loadcell_line.h"
#include "daq/protocol/rig.h"

/* Where the unit of a number comes from. */
enum wb_unit_rule {
    WB_UNIT_PRINTED,    /* every line has it */
    WB_UNIT_IF_STABLE,  /* the line has it while the load is at rest, and blanks otherwise */
    WB_UNIT_OF_RIG_FILE /* no line has it: the row's, or that of the rig file */
};

/* A line that answers a command. */
struct wb_loadcell_answer {
    const char *text;    /* the whole line, without blanks around it */
    const char *meaning; /* why it is refused; NULL: the command was taken, and nothing is said */
    bool overload;       /* it stands for a reading out of range */
};

#define WB_PRESET_ANSWERS 8
struct wb_loadcell_preset {
    const char *name;    /* in rig files */
    const char *summary; /* maker and instrument, a few words */
    const char *line;    /* "9600,8n1", for what the address leaves out; NULL: it must say it */
    const char *terminator;
    enum wb_unit_rule unit_rule;
    const char *unit; /* where lines have none; NULL: the rig file must give it */
    double scale;     /* 0 means 1 */
    int sign;         /* of tension; 0 means +1 */
    char delimiter;   /* with column; 0: the whole line is one value */
    int column;
    /* A stream is begun by `start` and asked for again when it falls silent; NULL: the instrument
     * streams by itself, or is asked. `request` asks for one reading, at once, whether stable or
     * not; NULL: it cannot be asked. */
    const char *start, *stop, *request;
    int64_t period_ns; /* of the requests where there is no stream; 0: it streams by itself */
    const char *tare;
    int64_t settle_ns;                                    /* silence after the port was opened */
    const char *overloads[5];                             /* words, NULL after the last */
    struct wb_loadcell_answer answers[WB_PRESET_ANSWERS]; /* text NULL after the last */
};

/* The row at an index; NULL beyond the last. */
const struct wb_loadcell_preset *wb_loadcell_preset_at(size_t index);
/* By name; NULL when there is none. */
const struct wb_loadcell_preset *wb_loadcell_preset_find(const char *name);

/* Sets what the row sets, all but the address, in the settings of a cell whose file gives none of
 * it. The cell's scale and sign are overwritten, too. */
void wb_loadcell_preset_apply(const struct wb_loadcell_preset *preset,
                              struct wb_rig_load_cell *cell);

/* The cell is asked with the row's request instead of streaming. */
void wb_loadcell_preset_ask(const struct wb_loadcell_preset *preset, struct wb_rig_load_cell *cell);

/* Adds baud rate and frame of the row to an address `serial:...` that leaves them out. False when
 * the address grows too long for `size`. */
bool wb_loadcell_preset_complete_address(const struct wb_loadcell_preset *preset, char *address,
                                         size_t size);

/* Reads one line of `length` bytes without its terminator, as wb_line_decode() does. */
void wb_loadcell_preset_decode(const struct wb_loadcell_preset *preset, const char *bytes,
                               size_t length, const struct wb_rig_load_cell *cell,
                               struct wb_line_reading *reading);

#endif
