/* What every function of the library begins and ends with: messages go to the calling thread's
 * texts instead of a stream, and structs of other releases are read and written as far as both
 * sides know them.
 *
 *     wb_call_begin();
 *     ...
 *     return wb_call_end(status);
 */
#ifndef WB_LIBRARY_CALL_H
#define WB_LIBRARY_CALL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/columns.h"
#include "base/memory.h"
#include "base/status.h"
#include "include/wirebench.h"

struct wirebench_table {
    struct wb_columns columns;
};

/* A call under way, in its function's frame. */
struct wb_call {
    struct wb_memory_guard guard;
    int n_without_handler; /* of this thread, when it began */
};

/* Forgets this thread's message and warnings. Where an allocation fails from here to the end, the
 * function returns WIREBENCH_ERR_MEMORY from this line; what it owned then is lost. */
#define wb_call_begin()                                                                            \
    struct wb_call wb_call_;                                                                       \
    wb_call_start(&wb_call_);                                                                      \
    if (setjmp(wb_call_.guard.target) != 0)                                                        \
    return wb_call_abandon(&wb_call_)
void wb_call_start(struct wb_call *call);
enum wirebench_status wb_call_abandon(const struct wb_call *call);

/* The public status; sees to it that a failure has a message. */
enum wirebench_status wb_call_end(enum wb_status status);
/* The same of a success that lacks something, which the message says. */
enum wirebench_status wb_call_end_incomplete(const char *format, ...)
    __attribute__((format(printf, 1, 2)));

/* Appends a line to this thread's warnings. */
void wb_call_warn(const char *text);

/* Copies a struct that the caller filled in, whose first member is its size, to `mine` (n bytes),
 * and zeroes what it does not have. WB_ERR_ARGUMENT where the size was not set, or where members
 * that this release does not know are not 0. `name` is the struct's. */
WB_MUST_CHECK enum wb_status wb_call_take(void *mine, size_t n, const void *given,
                                          const char *name);

/* Copies a result (n bytes) to the caller's struct as far as that reaches, whose size stays;
 * zeroes what lies beyond. WB_ERR_ARGUMENT where the size was not set. */
WB_MUST_CHECK enum wb_status wb_call_give(void *given, const void *mine, size_t n,
                                          const char *name);

/* Between the two, GSL's error handler, which belongs to the process and aborts it by default, is
 * off. Any thread may be between them; the caller's handler is back when the last has left. */
void wb_call_begin_gsl(void);
void wb_call_end_gsl(void);

/* WB_ERR_ARGUMENT with a message where a pointer is NULL that must not be. */
WB_MUST_CHECK enum wb_status wb_call_need(const void *pointer, const char *name);

#endif
