/* The arrays of one object: taken one by one, looked at once, released at once.
 *
 *     mesh->node = wb_memory_take(&mesh->memory, n, sizeof *mesh->node);
 *     mesh->part = wb_memory_take(&mesh->memory, n, sizeof *mesh->part);
 *     if (mesh->memory.failed)
 *         return wb_fail(WB_ERR_MEMORY, "no memory for %d nodes", n);
 *     ...
 *     wb_memory_release(&mesh->memory);
 */
#ifndef WB_BASE_MEMORY_H
#define WB_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

/* All zero at first. */
struct wb_memory {
    bool failed;   /* an array was not there to take */
    void **blocks; /* (n), owned */
    size_t n, room;
};

/* An array of `count` (0: 1) zeroed elements of `size` bytes; NULL, and `failed`, without memory.
 */
void *wb_memory_take(struct wb_memory *memory, size_t count, size_t size);

/* The same for an array that was allocated elsewhere, or NULL where that failed. */
void *wb_memory_keep(struct wb_memory *memory, void *block);

void wb_memory_release(struct wb_memory *memory); /* accepts a zeroed one, and leaves one */

#endif
