/* Between stream.c and the kinds of streams: the table's entry and the line settings that serial
 * ports and pseudo-terminals share. Nobody else includes this. */
#ifndef WB_DAQ_STREAM_PRIVATE_H
#define WB_DAQ_STREAM_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* One kind of stream. The core allocates `state_size` zeroed bytes for it. open() gets what
 * follows "scheme:"; when it fails it has released everything and logged why. */
struct wb_stream_kind {
    const char *scheme;
    size_t state_size;
    enum wb_status (*open)(void *state, const char *rest);
    void (*close)(void *state);
    int (*descriptors)(const void *state, int descriptors[2]);
    enum wb_status (*read)(void *state, void *buffer, size_t size, size_t *n);
    enum wb_status (*write)(void *state, const void *bytes, size_t n);
    uint64_t (*kernel_drops)(const void *state); /* NULL: cannot tell */
};

extern const struct wb_stream_kind wb_stream_serial;
extern const struct wb_stream_kind wb_stream_pty;
extern const struct wb_stream_kind wb_stream_udp;
extern const struct wb_stream_kind wb_stream_memory;

struct wb_stream;

/* The state of a stream of that kind; NULL when it is of another kind. */
void *wb_stream_state_of(struct wb_stream *stream, const struct wb_stream_kind *kind);

/* A write that takes longer fails. */
#define WB_STREAM_WRITE_TIMEOUT_NS INT64_C(50000000)

/* `PATH[,BAUD][,8n1][,dtr=on|off][,rts=on|off][,flow=none|xonxoff|rtscts]`, in any order after the
 * path. */
struct wb_stream_line {
    char path[256];
    int baud;    /* default 9600 */
    int bits;    /* 5 to 8 */
    char parity; /* 'n', 'e' or 'o' */
    int stop;    /* 1 or 2 */
    int dtr;     /* +1 on, -1 off, 0 as the driver leaves it */
    int rts;     /* the same */
    char flow;   /* 'n' none, 'x' XON/XOFF, 'r' RTS/CTS */
};

WB_MUST_CHECK enum wb_status wb_stream_parse_line(const char *rest, struct wb_stream_line *line);

/* Fails with the message for a device that cannot be opened with this errno; for a permission
 * error it says which group to join. `hint` (may be "") is appended to "not found". */
WB_MUST_CHECK enum wb_status wb_stream_fail_open(const char *path, int error, const char *hint);

/* Takes the advisory lock that keeps a second wirebench off the device. */
WB_MUST_CHECK enum wb_status wb_stream_lock(int descriptor, const char *path);

/* After a read of 0 bytes: true when the device hung up or went away. */
bool wb_stream_gone(int descriptor);

/* Waits until the descriptor takes bytes or `deadline_ns` (host monotonic) passed; false then. */
bool wb_stream_wait_writable(int descriptor, int64_t deadline_ns);

#endif
