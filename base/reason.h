/* Why something failed, as a text that travels with the result instead of going to the log.
 *
 * A caller who expects that a call may fail, and who reports that as part of its own result, owns
 * a zeroed wb_reason and passes it down. The function that fails writes the reason with
 * wb_fail_to() and returns the status as after wb_fail(). Where the caller passes NULL, the message
 * is logged as an error, so that one function serves both kinds of callers.
 */
#ifndef WB_BASE_REASON_H
#define WB_BASE_REASON_H

#include <stdbool.h>

#include "base/status.h"

/* All zero: there is none. A text that does not fit is cut at the end of a UTF-8 character and ends
 * in "...". */
struct wb_reason {
    char text[1024];
};

/* Replaces the text. It may be made of the present one. */
void wb_reason_set(struct wb_reason *reason, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Replaces the text of `reason`, or adds to it where that is wanted; logs an error of that domain
 * where it is NULL. Called by the two below. */
void wb_reason_tell(struct wb_reason *reason, bool also, const char *domain, const char *format,
                    ...) __attribute__((format(printf, 4, 5)));

/* Writes the message to `reason`, or logs it as wb_fail() does where that is NULL, and evaluates to
 * `status`. A macro, so that the compiler sees that the caller returns an error. */
#define wb_fail_to(reason, status, ...)                                                            \
    (wb_reason_tell((reason), false, WB_LOG_DOMAIN, __VA_ARGS__), (status))

/* The same for one of several failures that the caller can go on after: `reason` keeps what it says
 * already, "; " between them. */
#define wb_fail_also(reason, status, ...)                                                          \
    (wb_reason_tell((reason), true, WB_LOG_DOMAIN, __VA_ARGS__), (status))

#endif
