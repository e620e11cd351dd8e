#include "base/memory.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "memory"

static _Thread_local struct wb_memory_guard *innermost;

void wb_memory_guard_begin(struct wb_memory_guard *guard)
{
    guard->outer = innermost;
    guard->gravest = wb_log_set_gravest(WB_LOG_ERROR);
    wb_log_set_gravest(guard->gravest);
    innermost = guard;
}

void wb_memory_guard_end(void)
{
    innermost = innermost->outer;
}

bool wb_memory_is_guarded(void)
{
    return innermost;
}

void wb_memory_end(const char *message)
{
    struct wb_memory_guard *const guard = innermost;
    wb_log_set_gravest(WB_LOG_ERROR);
    wb_error("%s", message);
    if (!guard)
        exit(EXIT_FAILURE);
    wb_memory_guard_end();
    wb_log_set_gravest(guard->gravest);
    longjmp(guard->target, 1);
}

static _Noreturn void end(size_t count, size_t size)
{
    char message[80] = "out of memory";
    if (size > 0)
        snprintf(message, sizeof message, "out of memory: no %zu x %zu bytes", count, size);
    wb_memory_end(message);
}

enum wb_status wb_memory_try(enum wb_status (*run)(void *context), void *context)
{
    struct wb_memory_guard guard;
    wb_memory_guard_begin(&guard);
    if (setjmp(guard.target) != 0)
        return WB_ERR_MEMORY;
    const enum wb_status status = run(context);
    wb_memory_guard_end();
    return status;
}

void *wb_memory_new(size_t count, size_t size)
{
    void *const block = calloc(count > 0 ? count : 1, size > 0 ? size : 1);
    if (!block)
        end(count, size);
    return block;
}

void *wb_memory_resize(void *block, size_t count, size_t size)
{
    const bool fits = size == 0 || count <= SIZE_MAX / size;
    const size_t n = count * size;
    void *const larger = fits ? realloc(block, n > 0 ? n : 1) : NULL;
    if (!larger)
        end(count, size);
    return larger;
}

void *wb_memory_room(void *block, size_t *room, size_t n, size_t size)
{
    if (block && n <= *room)
        return block;
    const size_t doubled = 2 * *room + 16, larger = doubled > n ? doubled : n;
    void *const grown = wb_memory_resize(block, larger, size);
    *room = larger; /* only after success: with wb_memory_try() the owner of the block survives the
                       failure */
    return grown;
}

void *wb_memory_need(void *block)
{
    if (!block)
        end(0, 0);
    return block;
}

char *wb_memory_text(const char *text)
{
    const size_t n = strlen(text) + 1;
    return memcpy(wb_memory_new(n, 1), text, n);
}

void *wb_memory_keep(struct wb_memory *memory, void *block)
{
    wb_memory_need(block);
    memory->blocks =
        wb_memory_room(memory->blocks, &memory->room, memory->n + 1, sizeof *memory->blocks);
    memory->blocks[memory->n++] = block;
    return block;
}

void *wb_memory_take(struct wb_memory *memory, size_t count, size_t size)
{
    return wb_memory_keep(memory, wb_memory_new(count, size));
}

void wb_memory_release(struct wb_memory *memory)
{
    for (size_t i = 0; i < memory->n; i++)
        free(memory->blocks[i]);
    free(memory->blocks);
    *memory = (struct wb_memory){0};
}
