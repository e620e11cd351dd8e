/* The interface between stream.c and the kinds of streams. */
#ifndef WB_DAQ_STREAM_STREAM_KIND_H
#define WB_DAQ_STREAM_STREAM_KIND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"

/* One kind of stream. stream.c allocates `state_size` zeroed bytes for its state. open() receives
 * the address after "scheme:"; if it fails, it has released everything and given the reason. */
struct wb_stream_kind {
    const char *scheme;
    size_t state_size;
    enum wb_status (*open)(void *state, const char *rest, struct wb_reason *why);
    void (*close)(void *state);
    int (*descriptors)(const void *state, int descriptors[2]);
    enum wb_status (*read)(void *state, void *buffer, size_t size, size_t *n);
    enum wb_status (*write)(void *state, const void *bytes, size_t n);
    bool (*reopen)(void *state);                 /* NULL: cannot be disconnected */
    uint64_t (*kernel_drops)(const void *state); /* NULL: no counter */
    const char *(*caution)(const void *state);   /* see wb_stream_caution(); NULL: never */
};

extern const struct wb_stream_kind wb_stream_serial;
extern const struct wb_stream_kind wb_stream_pty;
extern const struct wb_stream_kind wb_stream_udp;
extern const struct wb_stream_kind wb_stream_memory;

/* Registers one further kind, that of the virtual bench. The kind is borrowed. */
void wb_stream_kind_register(const struct wb_stream_kind *kind);

struct wb_stream {
    const struct wb_stream_kind *kind;
    char *address;
    void *state;
};

#endif
