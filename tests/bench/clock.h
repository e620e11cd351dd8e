/* The clock of benchmarks that measure work, whoever else uses the processors. */
#ifndef WB_TESTS_BENCH_CLOCK_H
#define WB_TESTS_BENCH_CLOCK_H

#include <time.h>

/* CPU time of this process, s. */
static inline double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

#endif
