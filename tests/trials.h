/* Counts of what a test tried, for docs/reliability.md: tests/reliability.sh runs the tests that
 * hold a promise and prints their counts as its table.
 */
#ifndef WB_TESTS_TRIALS_H
#define WB_TESTS_TRIALS_H

#include <errno.h> /* program_invocation_short_name */
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* `promise`: what holds, as a row of the table begins ("Every bit of a recording flipped");
 * `outcome`: what one trial is and what came of them all ("bits: all noticed"). Called where the
 * test has seen that all of them held. Printed always, and added to the file that WIREBENCH_TRIALS
 * of the environment names. */
__attribute__((format(printf, 3, 4))) static inline void
count_trials(const char *promise, uint64_t trials, const char *outcome, ...)
{
    char text[256], line[512];
    va_list arguments;
    va_start(arguments, outcome);
    vsnprintf(text, sizeof text, outcome, arguments);
    va_end(arguments);
    const int n = snprintf(line, sizeof line, "%s\t%" PRIu64 "\t%s\t%s\n", promise, trials, text,
                           program_invocation_short_name);
    printf("%s", line);
    const char *path = getenv("WIREBENCH_TRIALS");
    if (!path || n < 0 || (size_t)n >= sizeof line)
        return;
    const int descriptor = open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
    /* One write: tests run side by side. */
    if (descriptor < 0 || write(descriptor, line, (size_t)n) != n)
        fprintf(stderr, "cannot add to '%s'\n", path);
    if (descriptor >= 0)
        close(descriptor);
}

#endif
