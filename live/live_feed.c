#include "live/live_feed.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "live"

/* Size of a view's socket buffer (bytes as counted by the kernel): about a second of frames. */
#define SOCKET_BYTES 65536
#define LOW_PRIORITY 5 /* nice value of the views */

/* --- child process --- */

static volatile sig_atomic_t told_to_end;

static void note_end(int number)
{
    (void)number;
    told_to_end = 1;
}

bool wb_live_feed_is_told_to_end(void)
{
    return told_to_end != 0;
}

static void become_a_view(const struct wb_live_feed *feed)
{
    static const int ignored[] = {SIGINT, SIGQUIT, SIGTSTP, SIGTTIN, SIGTTOU, SIGPIPE};
    struct sigaction action = {.sa_handler = note_end};
    for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++)
        signal(ignored[i], SIG_IGN);
    sigemptyset(&action.sa_mask);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    /* Close the recorder's ends: otherwise an earlier view would not see that the recorder ended.
     */
    for (int i = 0; i < feed->n_views; i++)
        close(feed->view[i].socket);
    /* A failure is ignored: the view then runs at normal priority. */
    (void)setpriority(PRIO_PROCESS, 0, LOW_PRIORITY);
}

enum wb_status wb_live_feed_start(struct wb_live_feed *feed, int (*run)(int socket, void *context),
                                  void *context, int *index)
{
    int ends[2];
    const int bytes = SOCKET_BYTES;
    if (feed->n_views == WB_LIVE_FEED_VIEWS)
        return wb_fail(WB_ERR_ARGUMENT, "expected at most %d live views", WB_LIVE_FEED_VIEWS);
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
        return wb_fail(WB_ERR_IO, "a socket for a live view cannot be created: %s",
                       strerror(errno));
    (void)setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    fflush(NULL); /* otherwise the child would write buffered output a second time */
    const pid_t process = fork();
    if (process == 0) {
        close(ends[0]);
        wb_time_replace(NULL);
        become_a_view(feed);
        _exit(run(ends[1], context));
    }
    close(ends[1]);
    if (process < 0) {
        close(ends[0]);
        return wb_fail(WB_ERR_IO, "a process for a live view cannot be started: %s",
                       strerror(errno));
    }
    struct wb_live_feed_view *const view = &feed->view[feed->n_views];
    view->socket = ends[0];
    view->process = process;
    view->has_ended = view->ended_well = false;
    view->sent_points = feed->n_points;
    *index = feed->n_views++;
    return WB_OK;
}

/* --- sending --- */

/* True if the packet was sent; false if the socket buffer is full or the view has ended. */
static bool put(struct wb_live_feed_view *view, const void *packet, size_t size)
{
    if (atomic_load(&view->is_gone))
        return false;
    const ssize_t sent = send(view->socket, packet, size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOBUFS)
        atomic_store(&view->is_gone, true);
    return sent == (ssize_t)size;
}

void wb_live_feed_add_point(struct wb_live_feed *feed, const struct wb_live_frame_point *point)
{
    feed->ring[feed->n_points++ % WB_LIVE_FEED_RING] = *point;
}

/* Fills in the oldest points not yet sent to this view, as many as a frame holds. */
static void fill_points(const struct wb_live_feed *feed, struct wb_live_feed_view *view,
                        struct wb_live_frame *frame)
{
    const uint64_t waiting = feed->n_points - view->sent_points;
    if (waiting > WB_LIVE_FEED_RING) {
        view->points_dropped += waiting - WB_LIVE_FEED_RING;
        view->sent_points = feed->n_points - WB_LIVE_FEED_RING;
    }
    frame->n_points = 0;
    for (uint64_t i = view->sent_points;
         i < feed->n_points && frame->n_points < WB_LIVE_FRAME_POINTS; i++)
        frame->point[frame->n_points++] = feed->ring[i % WB_LIVE_FEED_RING];
}

void wb_live_feed_push(struct wb_live_feed *feed, struct wb_live_frame *frame)
{
    frame->header = wb_live_frame_header(WB_LIVE_FRAME_STATE, sizeof *frame);
    frame->number = ++feed->n_frames;
    for (int i = 0; i < feed->n_views; i++) {
        struct wb_live_feed_view *const view = &feed->view[i];
        fill_points(feed, view, frame);
        frame->frames_dropped = view->frames_dropped;
        frame->points_dropped = view->points_dropped;
        if (put(view, frame, sizeof *frame))
            view->sent_points += (uint64_t)frame->n_points;
        else
            view->frames_dropped++;
    }
}

void wb_live_feed_add_message(struct wb_live_feed *feed, enum wb_log_level level, const char *text)
{
    struct wb_live_frame_message message = {
        .header = wb_live_frame_header(WB_LIVE_FRAME_MESSAGE, sizeof message), .level = level};
    snprintf(message.text, sizeof message.text, "%s", text);
    for (int i = 0; i < feed->n_views; i++)
        (void)put(&feed->view[i], &message, sizeof message);
}

int wb_live_feed_key(struct wb_live_feed *feed)
{
    struct wb_live_frame_key key;
    for (int i = 0; i < feed->n_views; i++) {
        struct wb_live_feed_view *const view = &feed->view[i];
        if (atomic_load(&view->is_gone))
            continue;
        const ssize_t n = recv(view->socket, &key, sizeof key, MSG_DONTWAIT);
        if (n == 0)
            atomic_store(&view->is_gone, true);
        else if (wb_live_frame_is(&key.header, n, WB_LIVE_FRAME_KEY, sizeof key))
            return key.key;
    }
    return 0;
}

/* --- end --- */

bool wb_live_feed_has_ended(struct wb_live_feed *feed, int index)
{
    struct wb_live_feed_view *const view = &feed->view[index];
    int status;
    if (view->has_ended)
        return true;
    const pid_t ended = waitpid(view->process, &status, WNOHANG);
    view->has_ended = ended == view->process || (ended < 0 && errno == ECHILD);
    view->ended_well = ended == view->process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    return view->has_ended;
}

/* Waits for the end of a view until a deadline; true if it has ended. */
static bool wait_for_end(struct wb_live_feed *feed, int index, int64_t deadline_ns)
{
    while (!wb_live_feed_has_ended(feed, index)) {
        if (wb_time_now_ns() >= deadline_ns)
            return false;
        wb_time_sleep(wb_time_now_ns() + 10 * WB_NS_PER_MS);
    }
    return true;
}

void wb_live_feed_stop(struct wb_live_feed *feed, int patience_ms)
{
    const int64_t deadline_ns = wb_time_now_ns() + patience_ms * WB_NS_PER_MS;
    for (int i = 0; i < feed->n_views; i++)
        close(feed->view[i].socket);
    for (int i = 0; i < feed->n_views; i++) {
        if (wait_for_end(feed, i, deadline_ns))
            continue;
        kill(feed->view[i].process, SIGKILL); /* ends a stopped process as well */
        /* A process that waits for a dead network drive cannot be killed: do not wait longer. */
        (void)wait_for_end(feed, i, wb_time_now_ns() + WB_NS_PER_S);
    }
    feed->n_views = 0;
}
