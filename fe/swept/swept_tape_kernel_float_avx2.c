#include "fe/swept/swept_tape_kernel.inc"

const struct wb_swept_tape_kernel wb_swept_tape_kernel_float_avx2 = {"avx2", false, runs_here,
                                                                     forces, measure};
