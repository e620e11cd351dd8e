/* Server-sent events of a live view: what each client of the page has had, and what it gets next.
 * The events are described in docs/file-formats.md. */
#ifndef WB_LIVE_LIVE_EVENTS_H
#define WB_LIVE_LIVE_EVENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"
#include "live/live_history.h"
#include "live/live_plan.h"

/* How far a client is; all zero has had nothing. */
struct wb_live_events_cursor {
    bool has_plan, has_end;
    uint64_t frame; /* number of the last one it had */
    size_t points;
    uint64_t thinned; /* of the history when it had these points */
    int messages;
};

/* Appends all that is new to the client; nothing when there is nothing. `is_over`: the recorder has
 * gone, which is the last event. Running out of memory is remembered in the text. */
void wb_live_events_append(struct wb_live_events_cursor *cursor, const struct wb_live_plan *plan,
                           const struct wb_live_history *history, bool is_over,
                           struct wb_text *text);

#endif
