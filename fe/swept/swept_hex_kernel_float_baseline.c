#include "fe/swept/swept_hex_kernel.inc"

const struct wb_swept_hex_kernel wb_swept_hex_kernel_float_baseline = {"baseline", false, runs_here,
                                                                       four_points, one_point};
