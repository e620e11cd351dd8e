/* What every CMocka test of ours includes: the headers in the order cmocka wants, and comparisons
 * of doubles that fail on NaN (Debian's cmocka 1.1.5 has none). */
#ifndef WB_TESTS_CHECK_H
#define WB_TESTS_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/log.h"

/* Fails unless |actual - expected| <= tolerance (absolute). */
#define assert_close(actual, expected, tolerance)                                                  \
    do {                                                                                           \
        const double actual_ = (actual), expected_ = (expected), tolerance_ = (tolerance);         \
        if (!(fabs(actual_ - expected_) <= tolerance_))                                            \
            fail_msg("%s = %.17g, expected %.17g within %g", #actual, actual_, expected_,          \
                     tolerance_);                                                                  \
    } while (0)

/* Fails unless |actual - expected| <= fraction * |expected|. */
#define assert_close_relative(actual, expected, fraction)                                          \
    assert_close((actual), (expected), (fraction)*fabs(expected))

/* A sink for messages that a test provokes on purpose: wb_log_set_sink(discard_message, NULL). */
static inline void discard_message(void *context, enum wb_log_level level, const char *domain,
                                   const char *message)
{
    (void)context, (void)level, (void)domain, (void)message;
}

#endif
