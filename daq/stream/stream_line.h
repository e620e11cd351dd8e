/* Code shared by serial ports and pseudo-terminals: parsing addresses; locking, reading, writing
 * and waiting for a device. */
#ifndef WB_DAQ_STREAM_STREAM_LINE_H
#define WB_DAQ_STREAM_STREAM_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"

/* Timeout of a write, ns. */
#define WB_STREAM_WRITE_TIMEOUT_NS INT64_C(50000000)

/* `PATH[,BAUD][,8n1][,dtr=on|off|keep][,rts=on|off][,flow=none|xonxoff|rtscts]`, in any order after
 * the path. */
struct wb_stream_line {
    char path[256];
    int baud;       /* default 9600 */
    int bits;       /* 5 to 8 */
    char parity;    /* 'n', 'e' or 'o' */
    int stop;       /* 1 or 2 */
    int dtr;        /* +1 on, -1 off, 0: the driver's default */
    bool keeps_dtr; /* DTR is also kept after closing, so that opening again causes no edge */
    int rts;        /* +1 on, -1 off, 0: the driver's default */
    int flow;       /* 'n' none, 'x' XON/XOFF, 'r' RTS/CTS */
};

/* Reads a line as above. Here and below, `why` holds the message of a failure; NULL: it is logged.
 */
WB_MUST_CHECK enum wb_status wb_stream_parse_line(const char *rest, struct wb_stream_line *line,
                                                  struct wb_reason *why);

/* Turns the errno of a failed open into a status and message: for a permission error with the group
 * to join, for a busy port with the program that uses it. `hint` (may be "") is appended to the
 * message that the port does not exist. */
WB_MUST_CHECK enum wb_status wb_stream_fail_open(const char *path, int error, const char *hint,
                                                 struct wb_reason *why);

/* Takes the advisory lock that keeps other wirebench processes from using the device. */
WB_MUST_CHECK enum wb_status wb_stream_lock(int descriptor, const char *path,
                                            struct wb_reason *why);

/* An open device. The state of both kinds begins with this struct. */
struct wb_stream_port {
    int descriptor;             /* non-blocking; -1: closed after it was disconnected */
    struct wb_stream_line line; /* settings of its address */
    const char *gone;           /* static text: the likely cause when it is disconnected */
};

/* `descriptors`, `read` and `write` of both kinds; `state` points to a struct wb_stream_port. */
int wb_stream_port_descriptors(const void *state, int descriptors[2]);
WB_MUST_CHECK enum wb_status wb_stream_port_read(void *state, void *buffer, size_t size, size_t *n);
WB_MUST_CHECK enum wb_status wb_stream_port_write(void *state, const void *bytes, size_t n);

/* Waits until the descriptor is writable; false at `deadline_ns` (host monotonic). */
bool wb_stream_wait_writable(int descriptor, int64_t deadline_ns);

#endif
