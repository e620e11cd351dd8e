/* The recorder's side of its live views. A view is a child process at the other end of a socket; it
 * can be slow, stopped or killed without affecting the recording.
 *
 * Only wb_live_feed_stop(), which is called after the recording is closed, waits for a view. A
 * packet that cannot be sent at once is dropped and counted. Points of the curve are kept in a ring
 * of WB_LIVE_FEED_RING and sent with later frames, so that a view receives the whole curve after a
 * temporary delay; when the ring is full, the oldest points are dropped and counted.
 *
 * Views must be started before the process has threads, ports or a raised priority, because fork()
 * inherits them. Used by one thread, except wb_live_feed_add_message(), which any thread may call.
 */
#ifndef WB_LIVE_LIVE_FEED_H
#define WB_LIVE_LIVE_FEED_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/log.h"
#include "base/status.h"
#include "live/live_frame.h"

#define WB_LIVE_FEED_VIEWS 2
#define WB_LIVE_FEED_RING 4096

struct wb_live_feed_view {
    int socket; /* the recorder's end */
    pid_t process;
    uint64_t frames_dropped, points_dropped;
    uint64_t sent_points; /* number of points sent, counted over all points ever added */
    atomic_bool is_gone;  /* the other end is closed: the view is ending or has ended */
    bool has_ended;       /* the process has ended */
    bool ended_well;      /* with exit code 0: it has restored the terminal */
};

/* All zero: no views. */
struct wb_live_feed {
    int n_views;
    struct wb_live_feed_view view[WB_LIVE_FEED_VIEWS];
    uint64_t n_frames, n_points;
    struct wb_live_frame_point ring[WB_LIVE_FEED_RING];
};

/* Starts a view: calls `run` in a child process with the view's end of the socket; its return value
 * is the exit code of the process. The child ignores Ctrl-C, Ctrl-Z and broken pipes, reads the end
 * of the socket when the recorder has ended, and runs at low priority. *index receives the index of
 * the view. On failure no process is left. */
WB_MUST_CHECK enum wb_status wb_live_feed_start(struct wb_live_feed *feed,
                                                int (*run)(int socket, void *context),
                                                void *context, int *index);

/* In a view: whether it has received SIGTERM or SIGHUP, after which it must end. */
bool wb_live_feed_is_told_to_end(void);

/* Adds a point to the curve of all views. */
void wb_live_feed_add_point(struct wb_live_feed *feed, const struct wb_live_frame_point *point);

/* Sends a state to all views, each with the points that it has not received yet. Sets header,
 * number, drops and points of `frame`. */
void wb_live_feed_push(struct wb_live_feed *feed, struct wb_live_frame *frame);

/* Sends a message of the log to all views. */
void wb_live_feed_add_message(struct wb_live_feed *feed, enum wb_log_level level, const char *text);

/* The next key sent by a view; 0: none. Does not wait. */
int wb_live_feed_key(struct wb_live_feed *feed);

/* Whether the process of a view has ended; then view[index].ended_well is valid. Does not wait. */
bool wb_live_feed_has_ended(struct wb_live_feed *feed, int index);

/* Ends all views: closes their sockets, waits up to `patience_ms` for them to end, then kills them.
 * view[i] remains valid. Does nothing without views. */
void wb_live_feed_stop(struct wb_live_feed *feed, int patience_ms);

#endif
