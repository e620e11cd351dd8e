/* Real serial ports through libserialport, the only file that includes it. */
#include <errno.h>
#include <libserialport.h>
#include <limits.h>
#include <linux/serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>

#include "daq/stream_kind.h"
#include "daq/stream_line.h"

#define WB_LOG_DOMAIN "stream"

struct serial_state {
    struct wb_stream_port device; /* comes first; open while `port` is */
    struct sp_port *port;
};

/* "; ports that exist: /dev/ttyUSB0, /dev/ttyACM0", or that there is none. */
static void describe_ports(char *text, size_t size)
{
    struct sp_port **ports = NULL;
    size_t n = 0;
    if (sp_list_ports(&ports) != SP_OK || !ports || !ports[0]) {
        snprintf(text, size, "; no serial port is there at all: is the cable plugged in?");
    } else {
        n = (size_t)snprintf(text, size, "; ports that exist: ");
        for (int i = 0; ports[i] && n < size; i++)
            n += (size_t)snprintf(text + n, size - n, "%s%s", i ? ", " : "",
                                  sp_get_port_name(ports[i]));
    }
    if (ports)
        sp_free_port_list(ports);
}

/* The one place that turns libserialport's codes into ours. errno is that of the failed call. */
static enum wb_status fail_serial(enum sp_return code, const char *path, const char *doing)
{
    int error = errno;
    if (code == SP_ERR_ARG || code == SP_ERR_SUPP)
        return wb_fail(WB_ERR_UNSUPPORTED, "port '%s' does not support %s", path, doing);
    if (code == SP_ERR_MEM)
        return wb_fail(WB_ERR_MEMORY, "out of memory %s '%s'", doing, path);
    return wb_fail(WB_ERR_IO, "%s of port '%s' failed: %s", doing, path, strerror(error));
}

static enum wb_status set_modem_lines(struct sp_port *port, const struct wb_stream_line *line)
{
    enum sp_return code = SP_OK;
    if (line->dtr != 0)
        code = sp_set_dtr(port, line->dtr > 0 ? SP_DTR_ON : SP_DTR_OFF);
    if (code != SP_OK)
        return fail_serial(code, line->path, "setting the DTR line");
    if (line->rts != 0 && line->flow != 'r')
        code = sp_set_rts(port, line->rts > 0 ? SP_RTS_ON : SP_RTS_OFF);
    if (code != SP_OK)
        return fail_serial(code, line->path, "setting the RTS line");
    return WB_OK;
}

static enum wb_status apply_line(struct sp_port *port, const struct wb_stream_line *line)
{
    enum sp_return code = sp_set_baudrate(port, line->baud);
    if (code != SP_OK)
        return wb_fail(WB_ERR_UNSUPPORTED, "port '%s' does not support %d baud", line->path,
                       line->baud);
    code = sp_set_bits(port, line->bits);
    if (code == SP_OK)
        code = sp_set_parity(port, line->parity == 'n'   ? SP_PARITY_NONE
                                   : line->parity == 'e' ? SP_PARITY_EVEN
                                                         : SP_PARITY_ODD);
    if (code == SP_OK)
        code = sp_set_stopbits(port, line->stop);
    if (code == SP_OK)
        code = sp_set_flowcontrol(port, line->flow == 'x'   ? SP_FLOWCONTROL_XONXOFF
                                        : line->flow == 'r' ? SP_FLOWCONTROL_RTSCTS
                                                            : SP_FLOWCONTROL_NONE);
    if (code != SP_OK)
        return fail_serial(code, line->path, "setting bits, parity, stop bits or flow control");
    return set_modem_lines(port, line);
}

/* What libserialport does not offer, where the driver takes it: no second opener, arrival without
 * the 16 ms timer of FTDI chips, and with dtr=off or keep no pulse on DTR at closing: the edge of
 * the next opening would reset an Arduino. */
static void tune(int descriptor, const struct wb_stream_line *line)
{
    if (ioctl(descriptor, TIOCEXCL) != 0)
        wb_debug("'%s' cannot be kept from other programs: %s", line->path, strerror(errno));
    struct serial_struct serial;
    if (ioctl(descriptor, TIOCGSERIAL, &serial) == 0) {
        serial.flags |= ASYNC_LOW_LATENCY;
        if (ioctl(descriptor, TIOCSSERIAL, &serial) != 0)
            wb_debug("low latency of '%s' cannot be set: %s", line->path, strerror(errno));
    }
    struct termios settings;
    if ((line->dtr < 0 || line->keeps_dtr) && tcgetattr(descriptor, &settings) == 0) {
        settings.c_cflag &= ~(tcflag_t)HUPCL;
        if (tcsetattr(descriptor, TCSANOW, &settings) != 0)
            wb_debug("hang-up at closing of '%s' cannot be switched off", line->path);
    }
}

/* Opens the port and leaves errno of a failure in *error. */
static enum sp_return open_port(const char *path, struct sp_port **port, int *error)
{
    errno = 0;
    enum sp_return code = sp_get_port_by_name(path, port);
    if (code != SP_OK) {
        *error = code == SP_ERR_ARG ? ENODEV : errno;
        return code;
    }
    errno = 0;
    code = sp_open(*port, SP_MODE_READ_WRITE);
    *error = errno;
    if (code != SP_OK) {
        sp_free_port(*port);
        *port = NULL;
    }
    return code;
}

static enum wb_status serial_open(void *state, const char *rest)
{
    struct serial_state *serial = state;
    struct wb_stream_line line;
    WB_TRY(wb_stream_parse_line(rest, &line));
    /* libserialport takes the kernel's name only, not a link from /dev/serial/by-id. */
    char resolved[PATH_MAX];
    if (!realpath(line.path, resolved))
        snprintf(resolved, sizeof resolved, "%s", line.path);
    int error = 0;
    enum sp_return code = open_port(resolved, &serial->port, &error);
    if (code != SP_OK) {
        char hint[1024] = "";
        struct stat there;
        if (error == ENODEV && stat(resolved, &there) == 0)
            return wb_fail(WB_ERR_UNSUPPORTED,
                           "'%s' is not a serial port: for a pseudo-terminal write pty:%s",
                           line.path, line.path);
        if (error == ENODEV || error == ENOENT)
            describe_ports(hint, sizeof hint);
        return wb_stream_fail_open(line.path, error ? error : EIO, hint);
    }
    enum wb_status status = WB_OK;
    if (sp_get_port_handle(serial->port, &serial->device.descriptor) != SP_OK)
        status = wb_fail(WB_ERR_IO, "port '%s' has no descriptor", line.path);
    /* The lock keeps other wirebenches out, TIOCEXCL all other programs but root's. */
    if (status == WB_OK)
        status = wb_stream_lock(serial->device.descriptor, line.path);
    if (status == WB_OK)
        status = apply_line(serial->port, &line);
    if (status != WB_OK) {
        sp_close(serial->port);
        sp_free_port(serial->port);
        return status;
    }
    tune(serial->device.descriptor, &line);
    memcpy(serial->device.path, line.path, sizeof serial->device.path);
    serial->device.gone = "unplugged or switched off";
    return WB_OK;
}

static void serial_close(void *state)
{
    struct serial_state *serial = state;
    ioctl(serial->device.descriptor, TIOCNXCL);
    sp_close(serial->port);
    sp_free_port(serial->port);
}

const struct wb_stream_kind wb_stream_serial = {
    .scheme = "serial",
    .state_size = sizeof(struct serial_state),
    .open = serial_open,
    .close = serial_close,
    .descriptors = wb_stream_port_descriptors,
    .read = wb_stream_port_read,
    .write = wb_stream_port_write,
};
