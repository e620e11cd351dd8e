#define REAL_IS_DOUBLE

#include "fe/swept/swept_cohesion_kernel.inc"

const struct wb_swept_cohesion_kernel wb_swept_cohesion_kernel_double_baseline = {
    "baseline", true, runs_here, add_forces};
