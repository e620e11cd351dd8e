#define REAL_IS_DOUBLE
#include "fe/swept/swept_hex_kernel.inc"

const struct wb_swept_hex_kernel wb_swept_hex_kernel_double_avx512 = {"avx512", true, runs_here,
                                                                      four_points, one_point};
