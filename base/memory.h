/* Memory allocation that does not return on failure. A failed allocation ends the program with one
 * message and exit code 1; below wb_memory_try() it ends that call with WB_ERR_MEMORY. Callers do
 * not check the pointer. The recorder (daq/) uses the C library instead and checks, because it has
 * to stop a stage and close a file.
 *
 *     double *const x = wb_memory_new(n, sizeof *x);
 *     gsl_vector *const v = wb_memory_need(gsl_vector_alloc(n));
 *     ...
 *     free(x);
 *
 * Arrays of one object, released together:
 *
 *     mesh->node = wb_memory_take(&mesh->memory, n, sizeof *mesh->node);
 *     mesh->part = wb_memory_take(&mesh->memory, n, sizeof *mesh->part);
 *     ...
 *     wb_memory_release(&mesh->memory);
 */
#ifndef WB_BASE_MEMORY_H
#define WB_BASE_MEMORY_H

#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* `count` (0: 1) zeroed elements of `size` bytes, released with free(). */
void *wb_memory_new(size_t count, size_t size) __attribute__((returns_nonnull));

/* Resizes a block (may be NULL) to `count` (0: 1) elements of `size` bytes; added elements are not
 * zeroed. */
void *wb_memory_resize(void *block, size_t count, size_t size) __attribute__((returns_nonnull));

/* Ensures that a block (may be NULL) has room for at least `n` elements; *room is its capacity. A
 * block that is too small is doubled, so that appending elements one by one is cheap. */
void *wb_memory_room(void *block, size_t *room, size_t n, size_t size)
    __attribute__((returns_nonnull));

/* A copy of a text, released with free(). */
char *wb_memory_text(const char *text) __attribute__((returns_nonnull));

/* Returns `block`, which another library allocated; ends the program, as above, if it is NULL. */
void *wb_memory_need(void *block) __attribute__((returns_nonnull));

/* Ends the program with this message, or the call below wb_memory_try(), as a failed allocation
 * does: for a mistake in the program after which there is no result. */
_Noreturn void wb_memory_end(const char *message);

/* A list of blocks; initially all zero. */
struct wb_memory {
    void **blocks; /* (n), owned */
    size_t n, room;
};

/* As wb_memory_new(), and as wb_memory_need() for a block to be released with free(); both add the
 * block to `memory`. */
void *wb_memory_take(struct wb_memory *memory, size_t count, size_t size)
    __attribute__((returns_nonnull));
void *wb_memory_keep(struct wb_memory *memory, void *block) __attribute__((returns_nonnull));

void wb_memory_release(struct wb_memory *memory); /* accepts a zeroed struct, and leaves one */

/* Returns the result of run(context); WB_ERR_MEMORY, with a message, if an allocation in it failed.
 * The memory that it owned is then leaked, and it must not have held a lock or started a thread. */
WB_MUST_CHECK enum wb_status wb_memory_try(enum wb_status (*run)(void *context), void *context);

/* The parts of wb_memory_try(), for callers without such a function. If an allocation of this
 * thread fails between begin and end, it jumps to the setjmp(guard->target), and the guard has
 * ended. Guards nest. */
struct wb_memory_guard {
    jmp_buf target;
    struct wb_memory_guard *outer;
    int gravest; /* previous level of messages */
};
void wb_memory_guard_begin(struct wb_memory_guard *guard);
void wb_memory_guard_end(void);  /* ends the innermost guard */
bool wb_memory_is_guarded(void); /* true if this thread has a guard */

#endif
