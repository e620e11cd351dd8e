/* Reason of a failure, as a text that is returned with the result instead of being logged.
 *
 * A caller who expects that a call may fail, and who includes the failure in its own result, passes
 * a zeroed wb_reason. The failing function writes the reason with wb_fail_to() and returns the
 * status as after wb_fail(). If the caller passes NULL, the message is logged as an error, so that
 * one function serves both kinds of callers.
 */
#ifndef WB_BASE_REASON_H
#define WB_BASE_REASON_H

#include <stdbool.h>

#include "base/status.h"

/* All zero: no reason. A text that does not fit is cut after a UTF-8 character and ends in
 * "...". */
struct wb_reason {
    char text[1024];
};

/* Replaces the text. The arguments may include the current text. */
void wb_reason_set(struct wb_reason *reason, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Replaces the text of `reason`, or appends to it if `also`; logs an error in `domain` if `reason`
 * is NULL. Used by the macros below. */
void wb_reason_report(struct wb_reason *reason, bool also, const char *domain, const char *format,
                      ...) __attribute__((format(printf, 4, 5)));

/* Writes the message to `reason`, or logs it as wb_fail() does if that is NULL, and evaluates to
 * `status`. A macro, so that the compiler sees that the caller returns an error. */
#define wb_fail_to(reason, status, ...)                                                            \
    (wb_reason_report((reason), false, WB_LOG_DOMAIN, __VA_ARGS__), (status))

/* As wb_fail_to(), for one of several failures after which the caller continues: appends to
 * `reason` after "; ". */
#define wb_fail_also(reason, status, ...)                                                          \
    (wb_reason_report((reason), true, WB_LOG_DOMAIN, __VA_ARGS__), (status))

#endif
