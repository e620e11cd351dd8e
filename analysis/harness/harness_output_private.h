/* Functions of analysis/harness/harness_output.c that only tests use. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_OUTPUT_PRIVATE_H
#define WB_ANALYSIS_HARNESS_HARNESS_OUTPUT_PRIVATE_H

#include "analysis/harness/harness_output.h"

/* Whether a force depends on a torsional stiffness that is not measured: at a fifth of it the force
 * differs by more than 10 %. */
bool wb_harness_output_is_twist_sensitive(const struct wb_harness_force *force);

#endif
