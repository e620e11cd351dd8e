/* Real serial ports through libserialport, the only file that includes it. */
#include <errno.h>
#include <fcntl.h>
#include <libserialport.h>
#include <limits.h>
#include <linux/serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "daq/stream/stream_kind.h"
#include "daq/stream/stream_line.h"
#include "daq/stream/usb_identity.h"

#define WB_LOG_DOMAIN "stream"

struct serial_state {
    struct wb_stream_port device; /* comes first; open while `port` is */
    struct sp_port *port;         /* NULL: closed after it went away */
    struct wb_usb_identity identity;
    char caution[512]; /* see wb_stream_caution() */
};

/* Writes "; ports that exist: /dev/ttyUSB0, /dev/ttyACM0", or that no port exists. */
static void describe_ports(char *text, size_t size)
{
    struct sp_port **ports = NULL;
    size_t n = 0;
    if (sp_list_ports(&ports) != SP_OK || !ports || !ports[0]) {
        snprintf(text, size,
                 "; this computer has no serial port: check that the cable is plugged in");
    } else {
        n = (size_t)snprintf(text, size, "; ports that exist: ");
        for (int i = 0; ports[i] && n < size; i++)
            n += (size_t)snprintf(text + n, size - n, "%s%s", i ? ", " : "",
                                  sp_get_port_name(ports[i]));
    }
    if (ports)
        sp_free_port_list(ports);
}

/* Maps a code of libserialport to a status and message. errno must be that of the failed call. */
static enum wb_status fail_serial(enum sp_return code, const char *path, const char *doing,
                                  struct wb_reason *why)
{
    int error = errno;
    if (code == SP_ERR_ARG || code == SP_ERR_SUPP)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED, "port '%s' does not support %s", path, doing);
    if (code == SP_ERR_MEM)
        return wb_fail_to(why, WB_ERR_MEMORY, "out of memory %s '%s'", doing, path);
    return wb_fail_to(why, WB_ERR_IO, "%s of port '%s' failed: %s", doing, path, strerror(error));
}

static enum wb_status set_modem_lines(struct sp_port *port, const struct wb_stream_line *line,
                                      struct wb_reason *why)
{
    enum sp_return code = SP_OK;
    if (line->dtr != 0)
        code = sp_set_dtr(port, line->dtr > 0 ? SP_DTR_ON : SP_DTR_OFF);
    if (code != SP_OK)
        return fail_serial(code, line->path, "setting the DTR line", why);
    if (line->rts != 0 && line->flow != 'r')
        code = sp_set_rts(port, line->rts > 0 ? SP_RTS_ON : SP_RTS_OFF);
    if (code != SP_OK)
        return fail_serial(code, line->path, "setting the RTS line", why);
    return WB_OK;
}

static enum wb_status apply_line(struct sp_port *port, const struct wb_stream_line *line,
                                 struct wb_reason *why)
{
    enum sp_return code = sp_set_baudrate(port, line->baud);
    if (code != SP_OK)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED, "port '%s' does not support %d baud", line->path,
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
        return fail_serial(code, line->path, "setting bits, parity, stop bits or flow control",
                           why);
    return set_modem_lines(port, line, why);
}

/* Settings that libserialport lacks, as far as the driver supports them: exclusive access,
 * reception without the 16 ms latency timer of FTDI chips, and for dtr=off and dtr=keep no change
 * of DTR at closing, because the edge at the next opening would reset an Arduino. */
static void tune(int descriptor, const struct wb_stream_line *line)
{
    if (ioctl(descriptor, TIOCEXCL) != 0)
        wb_debug("exclusive access to '%s' cannot be set: %s", line->path, strerror(errno));
    struct serial_struct serial;
    if (ioctl(descriptor, TIOCGSERIAL, &serial) == 0) {
        serial.flags |= ASYNC_LOW_LATENCY;
        if (ioctl(descriptor, TIOCSSERIAL, &serial) != 0)
            wb_debug("low latency of '%s' cannot be set: %s", line->path, strerror(errno));
    }
    struct termios settings;
    const bool stays = line->dtr < 0 || line->keeps_dtr;
    if (tcgetattr(descriptor, &settings) == 0) {
        settings.c_cflag &= ~(tcflag_t)HUPCL;
        settings.c_cflag |= stays ? 0 : HUPCL; /* libserialport 0.1.2 clears HUPCL */
        if (tcsetattr(descriptor, TCSANOW, &settings) != 0)
            wb_debug("hang-up at closing of '%s' cannot be switched %s", line->path,
                     stays ? "off" : "on");
    }
}

/* Opens the port; *error receives the errno of a failure. */
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

static void identify(struct sp_port *port, struct wb_usb_identity *identity)
{
    *identity = (struct wb_usb_identity){0};
    snprintf(identity->port, sizeof identity->port, "%s", sp_get_port_name(port));
    identity->is_usb =
        sp_get_port_transport(port) == SP_TRANSPORT_USB &&
        sp_get_port_usb_vid_pid(port, &identity->vendor, &identity->product) == SP_OK;
    const char *const serial = sp_get_port_usb_serial(port);
    if (identity->is_usb && serial)
        snprintf(identity->serial, sizeof identity->serial, "%s", serial);
}

/* The latency timer of an FTDI adapter, ms: the longest time for which its chip buffers received
 * bytes. Read from sysfs for a port of this name ("ttyUSB0"); 0: another kind of port. */
static int latency_timer(const char *name)
{
    char path[NAME_MAX + 64], text[16] = "";
    snprintf(path, sizeof path, "/sys/class/tty/%.*s/device/latency_timer", NAME_MAX, name);
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return 0;
    const ssize_t n = read(descriptor, text, sizeof text - 1);
    close(descriptor);
    return n > 0 ? atoi(text) : 0;
}

/* The driver may ignore the request for low latency without an error. */
static void check_latency(struct serial_state *serial)
{
    const char *const port = sp_get_port_name(serial->port), *const slash = strrchr(port, '/');
    const char *const name = slash ? slash + 1 : port;
    const int latency_ms = latency_timer(name);
    serial->caution[0] = '\0';
    if (latency_ms > 1)
        snprintf(
            serial->caution, sizeof serial->caution,
            "the adapter at '%.128s' buffers bytes for up to %d ms (latency timer), which delays "
            "arrival times by as much: run 'echo 1 | sudo tee "
            "/sys/class/tty/%.64s/device/latency_timer', or install the udev rule of "
            "docs/instruments.md",
            serial->device.line.path, latency_ms, name);
}

/* Configures and locks the open port, or closes it. */
static enum wb_status prepare(struct serial_state *serial, struct wb_reason *why)
{
    const struct wb_stream_line *const line = &serial->device.line;
    enum wb_status status = WB_OK;
    if (sp_get_port_handle(serial->port, &serial->device.descriptor) != SP_OK)
        status = wb_fail_to(why, WB_ERR_IO, "port '%s' has no descriptor", line->path);
    /* The lock excludes other wirebench processes, TIOCEXCL all programs except root's. */
    if (status == WB_OK)
        status = wb_stream_lock(serial->device.descriptor, line->path, why);
    if (status == WB_OK)
        status = apply_line(serial->port, line, why);
    if (status != WB_OK) {
        sp_close(serial->port);
        sp_free_port(serial->port);
        serial->port = NULL;
        serial->device.descriptor = -1;
        return status;
    }
    tune(serial->device.descriptor, line);
    check_latency(serial);
    return WB_OK;
}

static enum wb_status serial_open(void *state, const char *rest, struct wb_reason *why)
{
    struct serial_state *serial = state;
    const struct wb_stream_line *const line = &serial->device.line;
    WB_TRY(wb_stream_parse_line(rest, &serial->device.line, why));
    /* libserialport accepts the kernel's name only, not a link such as /dev/serial/by-id/... */
    char resolved[PATH_MAX];
    if (!realpath(line->path, resolved))
        snprintf(resolved, sizeof resolved, "%s", line->path);
    int error = 0;
    enum sp_return code = open_port(resolved, &serial->port, &error);
    if (code != SP_OK) {
        char hint[1024] = "";
        struct stat there;
        if (error == ENODEV && stat(resolved, &there) == 0)
            return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                              "'%s' is not a serial port: for a pseudo-terminal write pty:%s",
                              line->path, line->path);
        if (error == ENODEV || error == ENOENT)
            describe_ports(hint, sizeof hint);
        return wb_stream_fail_open(line->path, error ? error : EIO, hint, why);
    }
    identify(serial->port, &serial->identity);
    serial->device.gone = "unplugged or switched off";
    return prepare(serial, why);
}

static void serial_close(void *state)
{
    struct serial_state *serial = state;
    if (!serial->port)
        return;
    ioctl(serial->device.descriptor, TIOCNXCL);
    sp_close(serial->port);
    sp_free_port(serial->port);
    serial->port = NULL;
    serial->device.descriptor = -1;
}

/* Finds the name that the adapter's port has now; false: the adapter is not connected. */
static bool find_again(const struct wb_usb_identity *wanted, char *name, size_t size)
{
    enum {
        MOST_PORTS = 64
    };
    struct wb_usb_identity there[MOST_PORTS];
    struct sp_port **ports = NULL;
    int n = 0;
    if (sp_list_ports(&ports) != SP_OK || !ports)
        return false;
    for (; ports[n] && n < MOST_PORTS; n++)
        identify(ports[n], &there[n]);
    sp_free_port_list(ports);
    const int found = wb_usb_identity_find(wanted, there, n);
    if (found >= 0)
        snprintf(name, size, "%s", there[found].port);
    return found >= 0;
}

static bool serial_reopen(void *state)
{
    struct serial_state *serial = state;
    char name[sizeof serial->identity.port];
    int error;
    serial_close(serial);
    if (!find_again(&serial->identity, name, sizeof name) ||
        open_port(name, &serial->port, &error) != SP_OK || prepare(serial, NULL) != WB_OK)
        return false;
    identify(serial->port, &serial->identity);
    return true;
}

static const char *serial_caution(const void *state)
{
    const struct serial_state *serial = state;
    return serial->caution;
}

const struct wb_stream_kind wb_stream_serial = {
    .scheme = "serial",
    .state_size = sizeof(struct serial_state),
    .open = serial_open,
    .close = serial_close,
    .descriptors = wb_stream_port_descriptors,
    .read = wb_stream_port_read,
    .write = wb_stream_port_write,
    .reopen = serial_reopen,
    .caution = serial_caution,
};
