/* What the live view shows on a terminal: drawn with ncurses into the window that it has begun. */
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

/* Colours; once, after ncurses has begun. */
void wb_live_screen_prepare(void);

/* Draws all of it, for the size that the window has now. */
void wb_live_screen_draw(const struct wb_live_screen *screen);

#endif
