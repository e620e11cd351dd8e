/* Draws the live view on a terminal with ncurses, which must have been initialised. */
#ifndef WB_LIVE_LIVE_SCREEN_H
#define WB_LIVE_LIVE_SCREEN_H

#include <stdbool.h>

#include "live/live_history.h"
#include "live/live_plan.h"

struct wb_live_screen {
    const struct wb_live_plan *plan;       /* borrowed */
    const struct wb_live_history *history; /* borrowed */
    bool is_unicode;
};

/* Defines the colours; call once after ncurses was initialised. */
void wb_live_screen_prepare(void);

/* Draws the whole view for the present size of the window. */
void wb_live_screen_draw(const struct wb_live_screen *screen);

#endif
