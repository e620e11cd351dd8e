#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>

void *wb_memory_keep(struct wb_memory *memory, void *block)
{
    if (block && memory->n == memory->room) {
        const size_t room = 2 * memory->room + 8;
        void **const blocks = realloc(memory->blocks, room * sizeof *blocks);
        if (blocks) {
            memory->blocks = blocks;
            memory->room = room;
        } else {
            free(block);
            block = NULL;
        }
    }
    if (block)
        memory->blocks[memory->n++] = block;
    else
        memory->failed = true;
    return block;
}

void *wb_memory_take(struct wb_memory *memory, size_t count, size_t size)
{
    const bool fits = size == 0 || count <= SIZE_MAX / size;
    return wb_memory_keep(memory, fits ? calloc(count > 0 ? count : 1, size) : NULL);
}

void wb_memory_release(struct wb_memory *memory)
{
    for (size_t i = 0; i < memory->n; i++)
        free(memory->blocks[i]);
    free(memory->blocks);
    *memory = (struct wb_memory){0};
}
