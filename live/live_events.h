/* Server-sent events of a live view, with the progress of each client of the page.
 * docs/file-formats.md describes the events. */
#ifndef WB_LIVE_LIVE_EVENTS_H
#define WB_LIVE_LIVE_EVENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"
#include "live/live_history.h"
#include "live/live_plan.h"

/* Progress of a client; all zero: nothing sent yet. */
struct wb_live_events_cursor {
    bool has_plan, has_end;
    uint64_t frame; /* number of the last frame sent */
    size_t points;
    uint64_t thinned; /* n_thinned of the history when these points were sent */
    int messages;
};

/* Appends all events that are new to the client. `is_over`: the recorder has ended, which is the
 * last event. */
void wb_live_events_append(struct wb_live_events_cursor *cursor, const struct wb_live_plan *plan,
                           const struct wb_live_history *history, bool is_over,
                           struct wb_text *text);

#endif
