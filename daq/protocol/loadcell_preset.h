/* Presets of the generic line protocol for known instruments, selected by `load_cell.preset` in the
 * rig file. Keys in the rig file have priority over the preset. docs/instruments.md describes how
 * to connect each instrument.
 *
 * A preset fills in settings (port, line end, unit, commands) and adds rules that settings cannot
 * express: lines that are replies to commands rather than readings, and that a line without a unit
 * is unstable. daq/protocol/loadcell_line.h decodes the lines.
 */
#ifndef WB_DAQ_PROTOCOL_LOADCELL_PRESET_H
#define WB_DAQ_PROTOCOL_LOADCELL_PRESET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/loadcell_line.h"
#include "daq/protocol/rig.h"

/* Source of the unit of a number. */
enum wb_unit_rule {
    WB_UNIT_PRINTED,    /* every line has it */
    WB_UNIT_IF_STABLE,  /* printed while the load is stable; otherwise blanks */
    WB_UNIT_OF_RIG_FILE /* never printed: that of the preset or of the rig file */
};

/* A line that is the reply to a command. */
struct wb_loadcell_answer {
    const char *text;    /* the whole line, without outer blanks */
    const char *meaning; /* error reported for this line; NULL: the command was accepted */
    bool overload;       /* the line means a reading out of range */
};

#define WB_PRESET_ANSWERS 8
struct wb_loadcell_preset {
    const char *name;       /* in rig files */
    const char *summary;    /* manufacturer and instrument */
    const char *line;       /* "9600,8n1", default of the address; NULL: the address must give it */
    const char *terminator; /* NULL: "any" */
    enum wb_unit_rule unit_rule;
    const char *unit; /* of lines without a unit; NULL: the rig file must give it */
    double scale;     /* 0 means 1 */
    int sign;         /* of tension; 0 means +1 */
    char delimiter;   /* with column; 0: the whole line is one value */
    int column;
    /* `start` begins a stream and is repeated if the stream falls silent; NULL: the instrument
     * streams by itself or is polled. `request` requests one reading at once, stable or not; NULL:
     * polling is not possible. */
    const char *start, *stop, *request;
    int64_t period_ns; /* of polling; 0: the instrument streams */
    const char *tare;
    int64_t settle_ns;                                    /* silence after opening the port */
    const char *overloads[5];                             /* words, NULL after the last */
    struct wb_loadcell_answer answers[WB_PRESET_ANSWERS]; /* text NULL after the last */
};

/* The preset at an index; NULL after the last. */
const struct wb_loadcell_preset *wb_loadcell_preset_at(size_t index);
/* Finds a preset by name; NULL: unknown. */
const struct wb_loadcell_preset *wb_loadcell_preset_find(const char *name);

/* Sets all settings of the preset except the address; they overwrite those of the cell, also scale
 * and sign. */
void wb_loadcell_preset_apply(const struct wb_loadcell_preset *preset,
                              struct wb_rig_load_cell *cell);

/* Sets the cell to be polled with the preset's request instead of streaming. */
void wb_loadcell_preset_ask(const struct wb_loadcell_preset *preset, struct wb_rig_load_cell *cell);

/* Adds baud rate and frame of the preset to an address `serial:...` without them. False if the
 * address becomes too long for `size`. */
bool wb_loadcell_preset_complete_address(const struct wb_loadcell_preset *preset, char *address,
                                         size_t size);

/* Decodes a line of `length` bytes without its terminator, like wb_line_decode(). */
void wb_loadcell_preset_decode(const struct wb_loadcell_preset *preset, const char *bytes,
                               size_t length, const struct wb_rig_load_cell *cell,
                               struct wb_line_reading *reading);

#endif
