/* A stream of bytes from the caller: replay and tests feed drivers through it. */
#include <stdlib.h>
#include <string.h>

#include "daq/stream/stream_kind.h"
#include "daq/stream/stream_private.h"

#define WB_LOG_DOMAIN "stream"

/* One block of wb_stream_memory_push(). */
struct run {
    struct run *next;
    size_t n, taken;
    uint8_t bytes[];
};

struct memory_state {
    struct run *first, *last;
    uint8_t *written;
    size_t n_written, written_capacity;
};

static enum wb_status memory_open(void *state, const char *rest, struct wb_reason *why)
{
    (void)why;
    (void)state;
    if (rest[0])
        return wb_fail(WB_ERR_ARGUMENT, "address 'memory:%s': expected nothing after 'memory:'",
                       rest);
    return WB_OK;
}

static void memory_close(void *state)
{
    struct memory_state *memory = state;
    while (memory->first) {
        struct run *next = memory->first->next;
        free(memory->first);
        memory->first = next;
    }
    free(memory->written);
}

static int memory_descriptors(const void *state, int descriptors[2])
{
    (void)state;
    (void)descriptors;
    return 0;
}

static enum wb_status memory_read(void *state, void *buffer, size_t size, size_t *n)
{
    struct memory_state *memory = state;
    struct run *run = memory->first;
    *n = 0;
    if (!run)
        return WB_OK;
    size_t take = run->n - run->taken;
    if (take > size)
        take = size;
    memcpy(buffer, run->bytes + run->taken, take);
    run->taken += take;
    *n = take;
    if (run->taken == run->n) {
        memory->first = run->next;
        if (!memory->first)
            memory->last = NULL;
        free(run);
    }
    return WB_OK;
}

static enum wb_status memory_write(void *state, const void *bytes, size_t n)
{
    struct memory_state *memory = state;
    if (n == 0)
        return WB_OK;
    if (n > memory->written_capacity - memory->n_written) {
        size_t capacity = 2 * memory->written_capacity + n;
        uint8_t *larger = realloc(memory->written, capacity);
        if (!larger)
            return wb_fail(WB_ERR_MEMORY, "out of memory for %zu bytes", n);
        memory->written = larger;
        memory->written_capacity = capacity;
    }
    memcpy(memory->written + memory->n_written, bytes, n);
    memory->n_written += n;
    return WB_OK;
}

const struct wb_stream_kind wb_stream_memory = {
    .scheme = "memory",
    .state_size = sizeof(struct memory_state),
    .open = memory_open,
    .close = memory_close,
    .descriptors = memory_descriptors,
    .read = memory_read,
    .write = memory_write,
};

/* NULL when the stream is of another kind. */
static struct memory_state *memory_of(struct wb_stream *stream)
{
    return stream->kind == &wb_stream_memory ? stream->state : NULL;
}

enum wb_status wb_stream_memory_push(struct wb_stream *stream, const void *bytes, size_t n)
{
    struct memory_state *memory = memory_of(stream);
    if (!memory)
        return wb_fail(WB_ERR_ARGUMENT, "'%s' is not a memory stream", stream->address);
    if (n == 0)
        return WB_OK; /* an empty block would read as "nothing pending" */
    struct run *run = malloc(sizeof *run + n);
    if (!run)
        return wb_fail(WB_ERR_MEMORY, "out of memory for %zu bytes", n);
    run->next = NULL;
    run->n = n;
    run->taken = 0;
    memcpy(run->bytes, bytes, n);
    if (memory->last)
        memory->last->next = run;
    else
        memory->first = run;
    memory->last = run;
    return WB_OK;
}

size_t wb_stream_memory_take_written(struct wb_stream *stream, void *buffer, size_t size)
{
    struct memory_state *memory = memory_of(stream);
    if (!memory || memory->n_written == 0)
        return 0;
    size_t take = memory->n_written < size ? memory->n_written : size;
    memcpy(buffer, memory->written, take);
    memory->n_written -= take;
    memmove(memory->written, memory->written + take, memory->n_written);
    return take;
}
