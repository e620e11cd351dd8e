/* Functions of fe/trial/wire_run.c that only tests use. */
#ifndef WB_FE_TRIAL_WIRE_RUN_PRIVATE_H
#define WB_FE_TRIAL_WIRE_RUN_PRIVATE_H

#include "fe/trial/wire_run.h"

/* Appends a row that has step, fraction, loads, tip, tangent, tension, vertical_force, increments
 * and iterations, and fills in cycle, phase, angle, force. `slack`: the strand carries no force.
 * `shape` is (n_shape x 3). Rows beyond the spare ones are dropped. */
void wb_wire_run_add(struct wb_wire_run *run, const struct wb_wire_model *model,
                     const struct wb_wire_row *row, bool slack, const double (*shape)[3]);

#endif
