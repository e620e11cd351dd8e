/* Curves as lines of text: the chart of the live view, printed where a view has the terminal no
 * more. */
#ifndef WB_LIVE_LIVE_PRINT_H
#define WB_LIVE_LIVE_PRINT_H

#include <stdbool.h>

#include "base/text.h"
#include "live/live_history.h"
#include "live/live_plan.h"

struct wb_live_print {
    int columns, rows; /* of the whole drawing, in characters */
    bool is_unicode;   /* Braille; else ASCII */
    bool is_coloured;  /* with the terminal's sequences for bright and faint */
};

/* Appends force over deflection of the history's points: the last cycle bright, earlier ones faint,
 * what the plan predicts dotted; with axes. */
void wb_live_print_curve(const struct wb_live_print *print, const struct wb_live_plan *plan,
                         const struct wb_live_history *history, struct wb_text *text);

#endif
