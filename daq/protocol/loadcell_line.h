/* One line of a load cell or scale: what it says, as a pure function on text.
 *
 * The generic line protocol takes what most indicators, scales and hobby amplifiers print: words
 * before the number (`ST,GS,`, `S S`, `Reading:`), the number with its sign possibly apart from it,
 * a unit, and a mark of stability after it. Overload, by word or by value, is looked for first:
 * `OL,+9999999E+19` is no number. A comma in a number is refused unless the rig file says that this
 * instrument writes decimal commas.
 */
#ifndef WB_DAQ_PROTOCOL_LOADCELL_LINE_H
#define WB_DAQ_PROTOCOL_LOADCELL_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/rig.h"

enum wb_line_kind {
    WB_LINE_EMPTY,    /* nothing but blanks */
    WB_LINE_VALUE,    /* a reading */
    WB_LINE_OVERLOAD, /* over or under range */
    WB_LINE_REFUSED   /* no reading: an error code, a greeting, rubbish; `reason` says what */
};

struct wb_line_reading {
    enum wb_line_kind kind;
    double value;       /* as printed, in `unit` */
    char unit[16];      /* as printed; "" when the line has none */
    bool unstable;      /* the line calls it unstable, or dynamic */
    const char *reason; /* static text, when refused */
};

/* Reads one line of `length` bytes without its terminator. Uses of `cell`: delimiter, column,
 * decimal_comma, unstable_tokens, overload_tokens. */
void wb_line_decode(const char *bytes, size_t length, const struct wb_rig_load_cell *cell,
                    struct wb_line_reading *reading);

/* Newtons per unit: of force units (N, mN, kN, uN, lbF, ozF, gf, kgf) themselves, of mass units (g,
 * kg, mg, t, lb, oz, ct) under `gravity` (m/s2). False when the unit is not known. */
bool wb_line_unit_factor(const char *unit, double gravity, double *newtons);

/* Force in N: sign x (scale x value + offset) x unit, with the unit on the line where it is a known
 * one, else the rig file's. What the instrument prints beside its number is believed: a rig file
 * may be of another day. False when there is no unit, or an unknown one. */
bool wb_line_force(const struct wb_line_reading *reading, const struct wb_rig_load_cell *cell,
                   double gravity, double *force);

/* True when the line and the rig file each name a known unit, and not the same one. */
bool wb_line_unit_contradicts(const struct wb_line_reading *reading,
                              const struct wb_rig_load_cell *cell);

#endif
