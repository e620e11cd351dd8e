/* The recorder's side of its live views. A view is a child process at the other end of a socket; it
 * can be slow, stopped or killed without any effect on the recording.
 *
 * Nothing here waits for a view but wb_live_feed_stop(), which is called when the recording is
 * closed. A packet that the socket does not take at once is dropped and counted. Points of the
 * curve wait in a ring of WB_LIVE_FEED_RING and go out with later frames, so that a view that was
 * slow for a while has the whole curve again; beyond the ring the oldest are dropped and counted.
 *
 * Views are started before the process has threads, ports or priority: a fork() inherits all of
 * them. Used by one thread, but for wb_live_feed_add_message(), which any thread may call.
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
    uint64_t sent_points; /* of all points ever added, those before this number are out */
    atomic_bool is_gone;  /* the other end is closed: the view ends, or has ended */
    bool has_ended;       /* and its process is no more, */
    bool ended_well;      /* which returned 0: it left all as it was */
};

/* All zero has no view. */
struct wb_live_feed {
    int n_views;
    struct wb_live_feed_view view[WB_LIVE_FEED_VIEWS];
    uint64_t n_frames, n_points;
    struct wb_live_frame_point ring[WB_LIVE_FEED_RING];
};

/* Starts a view: `run` is called in a child process with the view's end of the socket; what it
 * returns is the process's exit code. In the child Ctrl-C, Ctrl-Z and broken pipes are ignored, the
 * socket reads as ended when the recorder has gone, and the priority is low. *index receives the
 * view's place. On failure no process is left. */
WB_MUST_CHECK enum wb_status wb_live_feed_start(struct wb_live_feed *feed,
                                                int (*run)(int socket, void *context),
                                                void *context, int *index);

/* Adds a point to the curve of all views. */
void wb_live_feed_add_point(struct wb_live_feed *feed, const struct wb_live_frame_point *point);

/* Sends a state to all views, with the points that each has not had. Header, number, drops and
 * points of `frame` are filled in here. */
void wb_live_feed_push(struct wb_live_feed *feed, struct wb_live_frame *frame);

/* Sends a message of the log to all views. */
void wb_live_feed_add_message(struct wb_live_feed *feed, enum wb_log_level level, const char *text);

/* The next key that a view sent; 0 when there is none. Never waits. */
int wb_live_feed_key(struct wb_live_feed *feed);

/* Whether a view's process is no more; view[index].ended_well then says how it ended. Never waits.
 */
bool wb_live_feed_has_ended(struct wb_live_feed *feed, int index);

/* Ends all views: their sockets are closed, they have `patience_ms` to go by themselves, then they
 * are killed. view[i] still says how each ended. Harmless on a feed without
 * views. */
void wb_live_feed_stop(struct wb_live_feed *feed, int patience_ms);

#endif
