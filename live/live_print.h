/* Prints the chart of the live view as lines of text, after the view has left the terminal. */
#ifndef WB_LIVE_LIVE_PRINT_H
#define WB_LIVE_LIVE_PRINT_H

#include <stdbool.h>

#include "base/text.h"
#include "live/live_history.h"
#include "live/live_plan.h"

struct wb_live_print {
    int columns, rows; /* of the whole drawing, in characters */
    bool is_unicode;   /* Braille patterns; false: ASCII */
    bool is_coloured;  /* with terminal sequences for bright and faint */
};

/* Appends a chart of strand tension over deflection with axes: the last cycle bright, earlier ones
 * faint, the prediction dotted. */
void wb_live_print_curve(const struct wb_live_print *print, const struct wb_live_plan *plan,
                         const struct wb_live_history *history, struct wb_text *text);

#endif
