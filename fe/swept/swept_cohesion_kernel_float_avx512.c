#include "fe/swept/swept_cohesion_kernel.inc"

const struct wb_swept_cohesion_kernel wb_swept_cohesion_kernel_float_avx512 = {
    "avx512", false, runs_here, add_forces};
