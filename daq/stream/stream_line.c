#include "daq/stream/stream_line.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/config.h"
#include "base/timing.h"
#include "daq/stream/port_user.h"

#define WB_LOG_DOMAIN "stream"

/* "8n1" */
static bool parse_frame(const char *text, struct wb_stream_line *line)
{
    if (strlen(text) != 3 || text[0] < '5' || text[0] > '8' || (text[2] != '1' && text[2] != '2'))
        return false;
    char parity = (char)(text[1] | 0x20);
    if (parity != 'n' && parity != 'e' && parity != 'o')
        return false;
    line->bits = text[0] - '0';
    line->parity = parity;
    line->stop = text[2] - '0';
    return true;
}

static bool parse_baud(const char *text, int *baud)
{
    size_t n = strlen(text);
    if (n == 0 || n > 8 || strspn(text, "0123456789") != n)
        return false;
    *baud = atoi(text);
    return *baud >= 50 && *baud <= 4000000;
}

/* dtr=, rts= and flow=. */
static bool parse_word(const char *text, struct wb_stream_line *line)
{
    const struct {
        const char *text;
        int *target, value;
    } words[] = {
        {"dtr=on", &line->dtr, 1},         {"dtr=off", &line->dtr, -1},
        {"rts=on", &line->rts, 1},         {"rts=off", &line->rts, -1},
        {"flow=none", &line->flow, 'n'},   {"flow=xonxoff", &line->flow, 'x'},
        {"flow=rtscts", &line->flow, 'r'},
    };
    for (size_t i = 0; i < WB_COUNT(words); i++) {
        if (strcmp(text, words[i].text) != 0)
            continue;
        *words[i].target = words[i].value;
        return true;
    }
    return false;
}

static bool parse_option(const char *text, struct wb_stream_line *line)
{
    if (strcmp(text, "dtr=keep") == 0)
        return line->keeps_dtr = true;
    if (strlen(text) == 3 && strspn(text, "0123456789") < 3)
        return parse_frame(text, line);
    return parse_word(text, line) || parse_baud(text, &line->baud);
}

enum wb_status wb_stream_parse_line(const char *rest, struct wb_stream_line *line,
                                    struct wb_reason *why)
{
    *line = (struct wb_stream_line){.baud = 9600, .bits = 8, .parity = 'n', .stop = 1, .flow = 'n'};
    size_t n = strcspn(rest, ",");
    if (n == 0 || n >= sizeof line->path)
        return wb_fail_to(
            why, WB_ERR_ARGUMENT,
            "'%s' has no device path: expected PATH,BAUD,8n1 such as /dev/ttyUSB0,9600,8n1", rest);
    memcpy(line->path, rest, n);
    line->path[n] = '\0';
    const char *at = rest + n;
    while (*at == ',') {
        char option[32];
        n = strcspn(++at, ",");
        if (n >= sizeof option)
            return wb_fail_to(why, WB_ERR_ARGUMENT, "unknown line setting '%.*s' of '%s'", (int)n,
                              at, line->path);
        memcpy(option, at, n);
        option[n] = '\0';
        if (!parse_option(option, line))
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "unknown line setting '%s' of '%s': expected a baud rate, data bits, "
                              "parity and stop bits such as 8n1, dtr=on|off|keep, rts=on|off or "
                              "flow=none|xonxoff|rtscts",
                              option, line->path);
        at += n;
    }
    return WB_OK;
}

enum wb_status wb_stream_fail_open(const char *path, int error, const char *hint,
                                   struct wb_reason *why)
{
    char user[WB_PORT_USER_TEXT];
    switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case ENOTDIR:
        return wb_fail_to(why, WB_ERR_NOT_FOUND, "port '%s' does not exist%s", path, hint);
    case EACCES:
    case EPERM:
        return wb_fail_to(why, WB_ERR_PERMISSION,
                          "no permission to open port '%s': join the group dialout with 'sudo "
                          "usermod -aG dialout $USER' and log in again",
                          path);
    case EBUSY:
    case EWOULDBLOCK:
        if (wb_port_user(path, user))
            return wb_fail_to(
                why, WB_ERR_BUSY,
                "port '%s' is in use by another program (%s): close that program first", path,
                user);
        return wb_fail_to(why, WB_ERR_BUSY,
                          "port '%s' is in use by another program: close that program first ('sudo "
                          "fuser -v %s' shows it)",
                          path, path);
    default:
        return wb_fail_to(why, WB_ERR_IO, "port '%s' cannot be opened: %s", path, strerror(error));
    }
}

enum wb_status wb_stream_lock(int descriptor, const char *path, struct wb_reason *why)
{
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0)
        return WB_OK;
    return wb_stream_fail_open(path, errno == EWOULDBLOCK ? EBUSY : errno, "", why);
}

/* After a read of 0 bytes: true if the device was disconnected, false if no data is pending. */
static bool has_gone(int descriptor)
{
    struct pollfd wait = {.fd = descriptor, .events = POLLIN};
    return poll(&wait, 1, 0) > 0 && (wait.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

bool wb_stream_wait_writable(int descriptor, int64_t deadline_ns)
{
    for (;;) {
        struct pollfd wait = {.fd = descriptor, .events = POLLOUT};
        const int ready = wb_time_wait(&wait, 1, deadline_ns);
        if (ready > 0)
            return true;
        if (ready == 0 || errno != EINTR)
            return false;
    }
}

int wb_stream_port_descriptors(const void *state, int descriptors[2])
{
    const struct wb_stream_port *port = state;
    descriptors[0] = port->descriptor;
    return 1;
}

enum wb_status wb_stream_port_read(void *state, void *buffer, size_t size, size_t *n)
{
    const struct wb_stream_port *port = state;
    ssize_t got;
    *n = 0;
    do
        got = read(port->descriptor, buffer, size);
    while (got < 0 && errno == EINTR);
    if (got > 0) {
        *n = (size_t)got;
        return WB_OK;
    }
    const bool failed = got < 0 && errno != EAGAIN;
    if (failed && errno != EIO && errno != ENXIO && errno != ENODEV)
        return wb_fail(WB_ERR_IO, "port '%s' cannot be read: %s", port->line.path, strerror(errno));
    if (failed || has_gone(port->descriptor))
        return wb_fail(WB_ERR_IO, "port '%s' was disconnected: %s", port->line.path, port->gone);
    return WB_OK;
}

enum wb_status wb_stream_port_write(void *state, const void *bytes, size_t n)
{
    const struct wb_stream_port *port = state;
    int64_t deadline_ns = wb_time_now_ns() + WB_STREAM_WRITE_TIMEOUT_NS;
    size_t done = 0;
    while (done < n) {
        ssize_t put = write(port->descriptor, (const char *)bytes + done, n - done);
        if (put > 0) {
            done += (size_t)put;
            continue;
        }
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0 && errno != EAGAIN)
            return wb_fail(WB_ERR_IO, "port '%s' cannot be written to: %s", port->line.path,
                           strerror(errno));
        if (!wb_stream_wait_writable(port->descriptor, deadline_ns))
            return wb_fail(WB_ERR_TIMEOUT,
                           "port '%s' accepted only %zu of %zu bytes within 50 ms: check that the "
                           "instrument is on and its flow control is that of the rig file",
                           port->line.path, done, n);
    }
    return WB_OK;
}
