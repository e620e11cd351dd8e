/* What serial ports and pseudo-terminals share: their addresses, and how a device is locked, read,
 * written and waited for. */
#ifndef WB_DAQ_STREAM_STREAM_LINE_H
#define WB_DAQ_STREAM_STREAM_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"

/* A write that takes longer fails. */
#define WB_STREAM_WRITE_TIMEOUT_NS INT64_C(50000000)

/* `PATH[,BAUD][,8n1][,dtr=on|off|keep][,rts=on|off][,flow=none|xonxoff|rtscts]`, in any order after
 * the path. */
struct wb_stream_line {
    char path[256];
    int baud;       /* default 9600 */
    int bits;       /* 5 to 8 */
    char parity;    /* 'n', 'e' or 'o' */
    int stop;       /* 1 or 2 */
    int dtr;        /* +1 on, -1 off, 0 as the driver leaves it */
    bool keeps_dtr; /* and after closing, so that the next opening is no edge on it */
    int rts;        /* the same */
    char flow;      /* 'n' none, 'x' XON/XOFF, 'r' RTS/CTS */
};

/* What fails here says why in `why`; NULL: in the log. */
WB_MUST_CHECK enum wb_status wb_stream_parse_line(const char *rest, struct wb_stream_line *line,
                                                  struct wb_reason *why);

/* Fails with the message for a device that cannot be opened with this errno; for a permission
 * error it says which group to join, for a busy one who has it. `hint` (may be "") is appended to
 * "not found". */
WB_MUST_CHECK enum wb_status wb_stream_fail_open(const char *path, int error, const char *hint,
                                                 struct wb_reason *why);

/* Takes the advisory lock that keeps a second wirebench off the device. */
WB_MUST_CHECK enum wb_status wb_stream_lock(int descriptor, const char *path,
                                            struct wb_reason *why);

/* An open device: the state of both kinds begins with one. */
struct wb_stream_port {
    int descriptor;             /* non-blocking; -1: closed after it went away */
    struct wb_stream_line line; /* as its address says */
    const char *gone;           /* static text: how such a device goes away */
};

/* `descriptors`, `read` and `write` of both kinds; `state` points to a struct wb_stream_port. */
int wb_stream_port_descriptors(const void *state, int descriptors[2]);
WB_MUST_CHECK enum wb_status wb_stream_port_read(void *state, void *buffer, size_t size, size_t *n);
WB_MUST_CHECK enum wb_status wb_stream_port_write(void *state, const void *bytes, size_t n);

/* Waits until the descriptor takes bytes or `deadline_ns` (host monotonic) passed; false then. */
bool wb_stream_wait_writable(int descriptor, int64_t deadline_ns);

#endif
