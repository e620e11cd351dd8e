#define REAL_IS_DOUBLE
#include "fe/swept/swept_contact_kernel.inc"

const struct wb_swept_contact_kernel wb_swept_contact_kernel_double_baseline = {
    "baseline", true, runs_here, gather, press, scatter};
