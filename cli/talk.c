#include "cli/talk.h"
#include "cli/talk_private.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"

enum way {
    WAY_WRITE, /* a file, which does not block for long, or our own non-blocking descriptor */
    WAY_SEND,  /* a socket */
    WAY_BYTE   /* a blocking terminal: poll() guarantees room for one byte only */
};

static struct {
    int descriptor;
    bool is_own; /* to be closed */
    bool gone;   /* the reader has gone */
    enum way way;
    uint64_t lost, reported; /* dropped texts; those already reported */
    size_t n;
    char waiting[16384];
} talk = {.descriptor = STDERR_FILENO};

void wb_talk_open(int shared)
{
    struct stat status;
    char path[32];
    memset(&talk, 0, sizeof talk);
    talk.descriptor = shared;
    if (fstat(shared, &status) != 0)
        return;
    if (S_ISSOCK(status.st_mode))
        talk.way = WAY_SEND;
    if (!S_ISCHR(status.st_mode) && !S_ISFIFO(status.st_mode))
        return;
    /* Opened again, because O_NONBLOCK on the descriptor itself would apply to all processes that
     * share it, including the shell. */
    snprintf(path, sizeof path, "/proc/self/fd/%d", shared);
    const int descriptor = open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_APPEND | O_CLOEXEC);
    talk.is_own = descriptor >= 0;
    if (talk.is_own)
        talk.descriptor = descriptor;
    else
        talk.way = WAY_BYTE;
}

static ssize_t put(void)
{
    if (talk.way == WAY_SEND)
        return send(talk.descriptor, talk.waiting, talk.n, MSG_DONTWAIT | MSG_NOSIGNAL);
    struct pollfd polled = {.fd = talk.descriptor, .events = POLLOUT};
    if (poll(&polled, 1, 0) <= 0) {
        errno = EAGAIN;
        return -1;
    }
    return write(talk.descriptor, talk.waiting, talk.way == WAY_BYTE ? 1 : talk.n);
}

bool wb_talk_flush(void)
{
    while (talk.n > 0 && !talk.gone) {
        const ssize_t done = put();
        if (done < 0 && errno == EINTR)
            continue;
        if (done < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            return false;
        if (done < 0) {
            talk.gone = true;
            break;
        }
        talk.n -= (size_t)done;
        memmove(talk.waiting, talk.waiting + done, talk.n);
    }
    return !talk.gone;
}

static bool append(const char *text)
{
    const size_t n = strlen(text);
    if (talk.gone || n > sizeof talk.waiting - talk.n)
        return false;
    memcpy(talk.waiting + talk.n, text, n);
    talk.n += n;
    return true;
}

/* Reports losses once there is room for the following text as well, else each would be reported
 * alone. */
static void report_losses(size_t n_following)
{
    char text[128];
    if (talk.lost == talk.reported || sizeof talk.waiting - talk.n < sizeof text + n_following)
        return;
    snprintf(text, sizeof text,
             "wirebench: %" PRIu64 " messages were dropped: the terminal did not accept them in "
             "time\n",
             talk.lost - talk.reported);
    if (append(text))
        talk.reported = talk.lost;
}

bool wb_talk_say(const char *text)
{
    (void)wb_talk_flush();
    report_losses(strlen(text));
    const bool said = append(text);
    talk.lost += !said;
    (void)wb_talk_flush();
    return said;
}

uint64_t wb_talk_lost(void)
{
    return talk.lost;
}

void wb_talk_close(int patience_ms)
{
    const int64_t deadline_ns = wb_time_now_ns() + patience_ms * WB_NS_PER_MS;
    (void)wb_talk_flush();
    report_losses(0);
    while (!wb_talk_flush() && !talk.gone) {
        struct pollfd polled = {.fd = talk.descriptor, .events = POLLOUT};
        if (wb_time_wait(&polled, 1, deadline_ns) == 0)
            break;
    }
    if (talk.is_own)
        close(talk.descriptor);
    talk.is_own = false;
    talk.descriptor = STDERR_FILENO;
}
