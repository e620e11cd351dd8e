/* Wall and CPU time of this process. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_TIME_H
#define WB_ANALYSIS_SOLVE_SOLVE_TIME_H

/* s, from an arbitrary zero: use differences of two readings. */
struct wb_solve_time {
    double wall, cpu;
};

struct wb_solve_time wb_solve_time_now(void);

/* Adds the time since a reading. */
void wb_solve_time_add(struct wb_solve_time *sum, const struct wb_solve_time *start);

#endif
