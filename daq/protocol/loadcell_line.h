/* Decodes a line of a load cell or scale; pure functions of text.
 *
 * The generic line protocol accepts the lines of most indicators, scales and hobby amplifiers:
 * words before the number (`ST,GS,`, `S S`, `Reading:`), the number with its sign possibly
 * separated, a unit, and a mark of stability. Overload, as a word or a value, is checked first:
 * `OL,+9999999E+19` is not a reading. A comma in a number is rejected unless the rig file sets
 * decimal_comma.
 */
#ifndef WB_DAQ_PROTOCOL_LOADCELL_LINE_H
#define WB_DAQ_PROTOCOL_LOADCELL_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/rig.h"

enum wb_line_kind {
    WB_LINE_EMPTY,    /* only blanks */
    WB_LINE_VALUE,    /* a reading */
    WB_LINE_OVERLOAD, /* over or under range */
    WB_LINE_REFUSED   /* not a reading (an error code, a banner, invalid bytes); see `reason` */
};

struct wb_line_reading {
    enum wb_line_kind kind;
    double value;       /* as printed, in `unit` */
    char unit[16];      /* as printed; "": the line has none */
    bool unstable;      /* the line marks it as unstable or dynamic */
    const char *reason; /* static text, for WB_LINE_REFUSED */
};

/* Decodes a line of `length` bytes without its terminator. Uses delimiter, column, decimal_comma,
 * unstable_tokens and overload_tokens of `cell`. */
void wb_line_decode(const char *bytes, size_t length, const struct wb_rig_load_cell *cell,
                    struct wb_line_reading *reading);

/* Newtons per unit of force (N, mN, kN, uN, lbF, ozF, gf, kgf), or per unit of mass (g, kg, mg, t,
 * lb, oz, ct) with `gravity` (m/s2). False: unknown unit. */
bool wb_line_unit_factor(const char *unit, double gravity, double *newtons);

/* Force in N: sign x (scale x value + offset) x unit. The unit of the line has priority over that
 * of the rig file, which may be outdated. False if there is no unit, or an unknown one. */
bool wb_line_force(const struct wb_line_reading *reading, const struct wb_rig_load_cell *cell,
                   double gravity, double *force);

/* True if the line and the rig file have different known units. */
bool wb_line_unit_contradicts(const struct wb_line_reading *reading,
                              const struct wb_rig_load_cell *cell);

#endif
