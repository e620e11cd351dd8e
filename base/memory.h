/* Memory that is there. An allocation that fails ends the program with one message and exit code 1;
 * below wb_memory_try() it ends that call with WB_ERR_MEMORY. No caller looks at the pointer. The
 * recorder (daq/) does look: it has a stage to stop and a file to close, and uses the C library.
 *
 *     double *const x = wb_memory_new(n, sizeof *x);
 *     gsl_vector *const v = wb_memory_need(gsl_vector_alloc(n));
 *     ...
 *     free(x);
 *
 * Arrays of one object, released at once:
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

/* The same block, or NULL, with room for `count` (0: 1) elements of `size` bytes; what is added is
 * not zeroed. */
void *wb_memory_resize(void *block, size_t count, size_t size) __attribute__((returns_nonnull));

/* The same block, or NULL, with room for `n` elements at least: *room is what it has. Where it is
 * too small it doubles, so that elements added one by one cost little. */
void *wb_memory_room(void *block, size_t *room, size_t n, size_t size)
    __attribute__((returns_nonnull));

/* A copy of a text, released with free(). */
char *wb_memory_text(const char *text) __attribute__((returns_nonnull));

/* The same block; it ends the program, as above, where another library found no memory for it. */
void *wb_memory_need(void *block) __attribute__((returns_nonnull));

/* All zero at first. */
struct wb_memory {
    void **blocks; /* (n), owned */
    size_t n, room;
};

/* As wb_memory_new(), and as wb_memory_need() of a block for free(). */
void *wb_memory_take(struct wb_memory *memory, size_t count, size_t size)
    __attribute__((returns_nonnull));
void *wb_memory_keep(struct wb_memory *memory, void *block) __attribute__((returns_nonnull));

void wb_memory_release(struct wb_memory *memory); /* accepts a zeroed one, and leaves one */

/* What run(context) returns; WB_ERR_MEMORY, with a message, where an allocation below it failed.
 * Then what it owned is lost, and it must not have held a lock or a thread. */
WB_MUST_CHECK enum wb_status wb_memory_try(enum wb_status (*run)(void *context), void *context);

/* The parts of wb_memory_try(), for a caller that is no such function. An allocation of this thread
 * that fails between begin and end jumps to the place where setjmp(guard->target) was called, and
 * the guard has ended. Guards nest. */
struct wb_memory_guard {
    jmp_buf target;
    struct wb_memory_guard *outer;
    int gravest; /* level of messages, as it was */
};
void wb_memory_guard_begin(struct wb_memory_guard *guard);
void wb_memory_guard_end(void);  /* of the innermost one */
bool wb_memory_is_guarded(void); /* this thread is below one */

#endif
