/* What a live view knows: the last frame, the curve so far, and the last messages. */
#ifndef WB_LIVE_LIVE_HISTORY_H
#define WB_LIVE_LIVE_HISTORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "live/live_frame.h"

#define WB_LIVE_HISTORY_MESSAGES 8
/* When so many points have come, every second one is let go. */
#define WB_LIVE_HISTORY_POINTS 131072

/* All zero is empty. */
struct wb_live_history {
    bool has_frame;
    struct wb_live_frame frame; /* the last; its points are in `points` */
    int64_t frame_ns;           /* when it was received, host monotonic */
    size_t n_points;
    struct wb_live_frame_point *points; /* (n_points), owned */
    uint64_t n_thinned;                 /* how often every second point was let go */
    int n_messages;                     /* all that came; the last ones are kept */
    struct wb_live_frame_message message[WB_LIVE_HISTORY_MESSAGES]; /* number i at i % MESSAGES */
    /* The disk of the recording, as wb_live_history_check_disk() found it. */
    int64_t disk_due_ns;
    double disk_free; /* bytes; NaN: not known */
    double disk_left; /* s until it is full, at the mean rate of this test so far; NaN: not known */
    bool is_bad;      /* a packet was not understood, or memory is out: the view is to end */
};

/* Takes all packets that wait in the socket; never waits itself. False when there will be no more:
 * the recorder has gone, or the view is of no use any more. */
bool wb_live_history_receive(struct wb_live_history *history, int socket);

/* Looks at the room on the disk of the recording, every two seconds at most. Asking may take long
 * on a network drive; only the view waits. */
void wb_live_history_check_disk(struct wb_live_history *history, const char *recording);

void wb_live_history_release(struct wb_live_history *history);

#endif
