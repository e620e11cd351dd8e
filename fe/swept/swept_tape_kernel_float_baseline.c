#include "fe/swept/swept_tape_kernel.inc"

const struct wb_swept_tape_kernel wb_swept_tape_kernel_float_baseline = {
    "baseline", false, runs_here, forces, measure};
