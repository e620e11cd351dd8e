/* Prologue and epilogue of every function of the library: messages go to the calling thread's texts
 * instead of a stream, and structs of other releases are converted.
 *
 *     wb_call_begin();
 *     ...
 *     return wb_call_end(status);
 */
#ifndef WB_LIBRARY_CALL_H
#define WB_LIBRARY_CALL_H

#include <stddef.h>

#include "base/columns.h"
#include "base/memory.h"
#include "base/status.h"
#include "include/wirebench.h"

struct wirebench_table {
    struct wb_columns columns;
};

/* A call in progress, on the stack of its function. */
struct wb_call {
    struct wb_memory_guard guard;
    int n_without_handler; /* of this thread, at its beginning */
};

/* Clears this thread's message and warnings. If an allocation fails before the end, the function
 * returns WIREBENCH_ERR_MEMORY from this line; what it owned is leaked. */
#define wb_call_begin()                                                                            \
    struct wb_call wb_call_;                                                                       \
    wb_call_start(&wb_call_);                                                                      \
    if (setjmp(wb_call_.guard.target) != 0)                                                        \
    return wb_call_abandon(&wb_call_)
void wb_call_start(struct wb_call *call);
enum wirebench_status wb_call_abandon(const struct wb_call *call);

/* The public status; ensures that a failure has a message. */
enum wirebench_status wb_call_end(enum wb_status status);
/* The same for a success with missing results, which the message describes. */
enum wirebench_status wb_call_end_incomplete(const char *format, ...)
    __attribute__((format(printf, 1, 2)));

/* Appends a line to this thread's warnings. */
void wb_call_warn(const char *text);

/* Copies a struct from the caller, whose first member is its size, to `mine` (n bytes), and zeroes
 * members that it lacks. WB_ERR_ARGUMENT if the size was not set, or if members unknown to this
 * release are not 0. `name` is the struct's. */
WB_MUST_CHECK enum wb_status wb_call_take(void *mine, size_t n, const void *given,
                                          const char *name);

/* Copies a result (n bytes) to the caller's struct up to that struct's size, which stays; zeroes
 * its further members. WB_ERR_ARGUMENT if the size was not set. */
WB_MUST_CHECK enum wb_status wb_call_give(void *given, const void *mine, size_t n,
                                          const char *name);

/* GSL's error handler, which is global to the process and aborts it by default, is switched off
 * between these calls. Any number of threads may be between them; the last to leave restores the
 * caller's handler. */
void wb_call_begin_gsl(void);
void wb_call_end_gsl(void);

/* WB_ERR_ARGUMENT with a message if a required pointer is NULL. */
WB_MUST_CHECK enum wb_status wb_call_need(const void *pointer, const char *name);

#endif
