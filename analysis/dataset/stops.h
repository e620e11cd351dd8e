/* Stops of a bending test: rows without motion, as in the dwell at a turn. */
#ifndef WB_ANALYSIS_DATASET_STOPS_H
#define WB_ANALYSIS_DATASET_STOPS_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"

/* Rows `first` to `end` - 1 of a dataset, without those in which the motion may still decelerate or
 * already start. */
struct wb_stop {
    size_t first, end;
    double arrival, departure; /* s */
};

/* Finds the first `most` stops of a cycle (0: of all cycles) in which the tension exceeds a value,
 * N, in order: by the stage's travel where all rows have it, otherwise by the deflection. Returns
 * their number. A simulation has no stops. */
int wb_stops_find(const struct wb_dataset *dataset, int cycle, double least_tension,
                  struct wb_stop *stops, int most);

/* The stop at the turn of a cycle; false where there is none. */
bool wb_stops_at_turn(const struct wb_dataset *dataset, int cycle, struct wb_stop *stop);

/* Time of the largest deflection on the loading of a cycle; NaN: it has none. */
double wb_stops_turn_time(const struct wb_dataset *dataset, int cycle);

#endif
