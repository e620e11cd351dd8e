#define REAL_IS_DOUBLE

#include "fe/swept/swept_tape_kernel.inc"

const struct wb_swept_tape_kernel wb_swept_tape_kernel_double_avx512 = {"avx512", true, runs_here,
                                                                        forces, measure};
