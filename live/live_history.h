/* Data of a live view: the last frame, the curve so far, and the last messages. */
#ifndef WB_LIVE_LIVE_HISTORY_H
#define WB_LIVE_LIVE_HISTORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "live/live_frame.h"

#define WB_LIVE_HISTORY_MESSAGES 8
/* Capacity for points; when it is reached, every second point is removed. */
#define WB_LIVE_HISTORY_POINTS 131072

/* All zero: empty. */
struct wb_live_history {
    bool has_frame;
    struct wb_live_frame frame; /* the last frame; its points are in `points` */
    int64_t frame_ns;           /* its arrival, host monotonic */
    size_t n_points;
    struct wb_live_frame_point *points; /* (n_points), owned */
    uint64_t n_thinned;                 /* how often every second point was removed */
    int n_messages;                     /* received so far; the last ones are stored */
    struct wb_live_frame_message message[WB_LIVE_HISTORY_MESSAGES]; /* number i at i % MESSAGES */
    /* Disk of the recording, by wb_live_history_check_disk(). */
    int64_t disk_due_ns;
    double disk_free; /* bytes; NaN: unknown */
    double disk_left; /* s until it is full, at the mean data rate of this test; NaN: unknown */
    bool is_bad;      /* a packet was invalid, or out of memory: the view must end */
};

/* Receives all pending packets without waiting. False if the recorder has ended or the view must
 * end.
 */
bool wb_live_history_receive(struct wb_live_history *history, int socket);

/* Checks the free space on the disk of the recording, at most every two seconds. This may take long
 * on a network drive, but delays only the view. */
void wb_live_history_check_disk(struct wb_live_history *history, const char *recording);

void wb_live_history_release(struct wb_live_history *history);

#endif
