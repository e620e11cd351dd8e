#include "live/live_history.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/statvfs.h>

#include "base/timing.h"
#include "base/units.h"

#define DISK_NS (2 * WB_NS_PER_S) /* between two checks of the disk */

static void thin(struct wb_live_history *history)
{
    for (size_t i = 0; i < history->n_points / 2; i++)
        history->points[i] = history->points[2 * i];
    history->n_points /= 2;
    history->n_thinned++;
}

static bool take_frame(struct wb_live_history *history, const struct wb_live_frame *frame)
{
    if (!history->points)
        history->points = malloc(WB_LIVE_HISTORY_POINTS * sizeof *history->points);
    if (!history->points || frame->n_points < 0 || frame->n_points > WB_LIVE_FRAME_POINTS ||
        frame->n_markers < 0 || frame->n_markers > WB_SPECIMEN_MAX_MARKERS)
        return false;
    if (history->n_points + WB_LIVE_FRAME_POINTS > WB_LIVE_HISTORY_POINTS)
        thin(history);
    for (int i = 0; i < frame->n_points; i++)
        history->points[history->n_points++] = frame->point[i];
    history->frame = *frame;
    history->frame_ns = wb_time_now_ns();
    history->has_frame = true;
    return true;
}

union packet {
    struct wb_live_frame_header header;
    struct wb_live_frame frame;
    struct wb_live_frame_message message;
};

/* Adds a packet of n bytes; false if it is invalid. */
static bool take(struct wb_live_history *history, union packet *packet, ssize_t n)
{
    if (n < (ssize_t)sizeof packet->header)
        return false;
    if (wb_live_frame_is(&packet->header, n, WB_LIVE_FRAME_STATE, sizeof packet->frame))
        return take_frame(history, &packet->frame);
    if (!wb_live_frame_is(&packet->header, n, WB_LIVE_FRAME_MESSAGE, sizeof packet->message))
        return false;
    packet->message.text[sizeof packet->message.text - 1] = '\0';
    history->message[history->n_messages++ % WB_LIVE_HISTORY_MESSAGES] = packet->message;
    return true;
}

bool wb_live_history_receive(struct wb_live_history *history, int socket)
{
    union packet packet;
    while (!history->is_bad) {
        /* MSG_TRUNC: the size of a packet that does not fit, which is then invalid. */
        const ssize_t n = recv(socket, &packet, sizeof packet, MSG_DONTWAIT | MSG_TRUNC);
        if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            return true;
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        history->is_bad = !take(history, &packet, n);
    }
    return false;
}

void wb_live_history_release(struct wb_live_history *history)
{
    free(history->points);
    memset(history, 0, sizeof *history);
}

void wb_live_history_check_disk(struct wb_live_history *history, const char *recording)
{
    struct statvfs status;
    const struct wb_live_frame *const frame = &history->frame;
    const int64_t now_ns = wb_time_now_ns();
    if (now_ns < history->disk_due_ns)
        return;
    history->disk_due_ns = now_ns + DISK_NS;
    history->disk_free = history->disk_left = (double)NAN;
    if (statvfs(recording, &status) != 0)
        return;
    history->disk_free = (double)status.f_bavail * (double)status.f_frsize;
    if (frame->elapsed > 1.0 && frame->bytes > 0)
        history->disk_left = history->disk_free * frame->elapsed / (double)frame->bytes;
}
