/* The dwell at the turn of a cycle: fall of the tension at constant deflection. */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_HOLD_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_HOLD_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_data.h"

/* Finds arrival and departure at the turn of a cycle, and means of the tension over the dwell in
 * periods of growing length. */
void wb_cycle_hold_find(struct wb_cycle_data *data, const struct wb_dataset *dataset, int cycle);

/* Fall of the tension during the dwell. */
struct wb_cycle_relaxation {
    double duration;  /* s, of the dwell; 0: no dwell */
    double fall;      /* N, from the first period to the last */
    double deviation; /* N: standard error of it */
    double time;      /* s: of the best exponential */
    bool is_seen;     /* more than noise, and more than 0.1 % of the largest force */
    bool needs_two;   /* one exponential does not describe it */
};
void wb_cycle_hold_describe(const struct wb_cycle_data *data,
                            struct wb_cycle_relaxation *relaxation);

#endif
