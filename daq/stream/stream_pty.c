/* Pseudo-terminals (and any other terminal) through termios: libserialport needs a sysfs entry and
 * modem lines, which pseudo-terminals lack. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "daq/stream/stream_kind.h"
#include "daq/stream/stream_line.h"

#define WB_LOG_DOMAIN "stream"

static const struct {
    int baud;
    speed_t speed;
} speeds[] = {{50, B50},         {75, B75},         {110, B110},        {134, B134},
              {150, B150},       {200, B200},       {300, B300},        {600, B600},
              {1200, B1200},     {1800, B1800},     {2400, B2400},      {4800, B4800},
              {9600, B9600},     {19200, B19200},   {38400, B38400},    {57600, B57600},
              {115200, B115200}, {230400, B230400}, {460800, B460800},  {500000, B500000},
              {576000, B576000}, {921600, B921600}, {1000000, B1000000}};

static speed_t find_speed(int baud)
{
    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        if (speeds[i].baud == baud)
            return speeds[i].speed;
    }
    return 0;
}

static enum wb_status apply_line(int descriptor, const struct wb_stream_line *line,
                                 struct wb_reason *why)
{
    struct termios settings;
    if (tcgetattr(descriptor, &settings) < 0)
        return wb_fail_to(why, WB_ERR_IO, "'%s' is not a terminal: %s", line->path,
                          strerror(errno));
    cfmakeraw(&settings);
    speed_t speed = find_speed(line->baud);
    if (speed == 0)
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "baud rate %d of '%s' is not a standard rate such as 9600 or 115200",
                          line->baud, line->path);
    cfsetispeed(&settings, speed);
    cfsetospeed(&settings, speed);
    static const tcflag_t sizes[] = {CS5, CS6, CS7, CS8};
    settings.c_cflag &= ~(tcflag_t)(CSIZE | PARENB | PARODD | CSTOPB | CRTSCTS);
    settings.c_cflag |= sizes[line->bits - 5] | CLOCAL | CREAD;
    if (line->parity != 'n')
        settings.c_cflag |= PARENB;
    if (line->parity == 'o')
        settings.c_cflag |= PARODD;
    if (line->stop == 2)
        settings.c_cflag |= CSTOPB;
    if (line->flow == 'r')
        settings.c_cflag |= CRTSCTS;
    if (line->flow == 'x')
        settings.c_iflag |= IXON | IXOFF;
    settings.c_cc[VMIN] = 0;
    settings.c_cc[VTIME] = 0;
    if (tcsetattr(descriptor, TCSANOW, &settings) < 0)
        return wb_fail_to(why, WB_ERR_IO, "line settings of '%s' cannot be set: %s", line->path,
                          strerror(errno));
    return WB_OK;
}

static int open_terminal(const struct wb_stream_line *line)
{
    return open(line->path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
}

/* Locks and configures the open terminal, or closes it. */
static enum wb_status prepare(struct wb_stream_port *pty, int descriptor, struct wb_reason *why)
{
    enum wb_status status = wb_stream_lock(descriptor, pty->line.path, why);
    if (status == WB_OK)
        status = apply_line(descriptor, &pty->line, why);
    if (status == WB_OK)
        pty->descriptor = descriptor;
    else
        close(descriptor);
    return status;
}

static enum wb_status pty_open(void *state, const char *rest, struct wb_reason *why)
{
    struct wb_stream_port *pty = state;
    WB_TRY(wb_stream_parse_line(rest, &pty->line, why));
    const int descriptor = open_terminal(&pty->line);
    if (descriptor < 0)
        return wb_stream_fail_open(pty->line.path, errno, "", why);
    pty->gone = "its other end was closed";
    return prepare(pty, descriptor, why);
}

/* Reopens a link only, which may lead to a new terminal. The number of a closed pseudo-terminal may
 * meanwhile belong to an unrelated program. */
static bool pty_reopen(void *state)
{
    struct wb_stream_port *pty = state;
    struct stat found;
    if (pty->descriptor >= 0)
        close(pty->descriptor);
    pty->descriptor = -1;
    if (lstat(pty->line.path, &found) != 0 || !S_ISLNK(found.st_mode))
        return false;
    const int descriptor = open_terminal(&pty->line);
    return descriptor >= 0 && prepare(pty, descriptor, NULL) == WB_OK;
}

static void pty_close(void *state)
{
    struct wb_stream_port *pty = state;
    if (pty->descriptor >= 0)
        close(pty->descriptor);
}

const struct wb_stream_kind wb_stream_pty = {
    .scheme = "pty",
    .state_size = sizeof(struct wb_stream_port),
    .open = pty_open,
    .close = pty_close,
    .descriptors = wb_stream_port_descriptors,
    .read = wb_stream_port_read,
    .write = wb_stream_port_write,
    .reopen = pty_reopen,
};
