/* What tests of fe/trial/wire_run.h ask beside it. */
#ifndef WB_FE_TRIAL_WIRE_RUN_PRIVATE_H
#define WB_FE_TRIAL_WIRE_RUN_PRIVATE_H

#include "fe/trial/wire_run.h"

/* Appends a row that has step, fraction, loads, tip, tangent, tension, vertical_force, increments
 * and iterations, and completes it: cycle, phase, angle, force. `slack`: the strand carries
 * nothing. `shape` is (n_shape x 3). Rows beyond the spare ones are not taken. */
void wb_wire_run_add(struct wb_wire_run *run, const struct wb_wire_model *model,
                     const struct wb_wire_row *row, bool slack, const double (*shape)[3]);

#endif
