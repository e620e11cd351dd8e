#include "analysis/solve/solve_time.h"

#include <time.h>

static double seconds(clockid_t clock)
{
    struct timespec now = {0};
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct wb_solve_time wb_solve_time_now(void)
{
    return (struct wb_solve_time){.wall = seconds(CLOCK_MONOTONIC),
                                  .cpu = seconds(CLOCK_PROCESS_CPUTIME_ID)};
}

void wb_solve_time_add(struct wb_solve_time *sum, const struct wb_solve_time *start)
{
    const struct wb_solve_time end = wb_solve_time_now();
    sum->wall += end.wall - start->wall;
    sum->cpu += end.cpu - start->cpu;
}
