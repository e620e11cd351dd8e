#include "daq/stream/stream.h"

#include <stdlib.h>
#include <string.h>

#include "daq/stream/stream_kind.h"

#define WB_LOG_DOMAIN "stream"

/* The last entry is set by wb_stream_kind_register(). */
static const struct wb_stream_kind *kinds[] = {&wb_stream_serial, &wb_stream_pty, &wb_stream_udp,
                                               &wb_stream_memory, NULL};

void wb_stream_kind_register(const struct wb_stream_kind *kind)
{
    kinds[sizeof kinds / sizeof kinds[0] - 1] = kind;
}

static const struct wb_stream_kind *find_kind(const char *address)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0] && kinds[i]; i++) {
        size_t n = strlen(kinds[i]->scheme);
        if (strncmp(address, kinds[i]->scheme, n) == 0 && address[n] == ':')
            return kinds[i];
    }
    return NULL;
}

enum wb_status wb_stream_open(struct wb_stream **out, const char *address)
{
    return wb_stream_open_with_reason(out, address, NULL);
}

enum wb_status wb_stream_open_with_reason(struct wb_stream **out, const char *address,
                                          struct wb_reason *why)
{
    *out = NULL;
    const struct wb_stream_kind *kind = find_kind(address);
    if (!kind)
        return wb_fail_to(
            why, WB_ERR_ARGUMENT,
            "unknown address '%s': expected serial:PORT,BAUD,8n1 or pty:PATH or udp:HOST:PORT",
            address);
    struct wb_stream *stream = calloc(1, sizeof *stream);
    char *copy = strdup(address);
    void *state = calloc(1, kind->state_size);
    enum wb_status status = WB_OK;
    if (!stream || !copy || !state)
        status = wb_fail_to(why, WB_ERR_MEMORY, "out of memory opening '%s'", address);
    else
        status = kind->open(state, address + strlen(kind->scheme) + 1, why);
    if (status != WB_OK) {
        free(state);
        free(copy);
        free(stream);
        return status;
    }
    stream->kind = kind;
    stream->address = copy;
    stream->state = state;
    *out = stream;
    return WB_OK;
}

void wb_stream_close(struct wb_stream *stream)
{
    if (!stream)
        return;
    stream->kind->close(stream->state);
    free(stream->state);
    free(stream->address);
    free(stream);
}

const char *wb_stream_address(const struct wb_stream *stream)
{
    return stream->address;
}

int wb_stream_descriptors(const struct wb_stream *stream, int descriptors[2])
{
    return stream->kind->descriptors(stream->state, descriptors);
}

enum wb_status wb_stream_read(struct wb_stream *stream, void *buffer, size_t size, size_t *n)
{
    return stream->kind->read(stream->state, buffer, size, n);
}

enum wb_status wb_stream_write(struct wb_stream *stream, const void *bytes, size_t n)
{
    return stream->kind->write(stream->state, bytes, n);
}

const char *wb_stream_caution(const struct wb_stream *stream)
{
    return stream->kind->caution ? stream->kind->caution(stream->state) : "";
}

uint64_t wb_stream_kernel_drops(const struct wb_stream *stream)
{
    return stream->kind->kernel_drops ? stream->kind->kernel_drops(stream->state) : 0;
}

bool wb_stream_reopen(struct wb_stream *stream)
{
    return stream->kind->reopen && stream->kind->reopen(stream->state);
}
