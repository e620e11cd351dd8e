#include "fe/swept/swept_contact_kernel.inc"

const struct wb_swept_contact_kernel wb_swept_contact_kernel_float_baseline = {
    "baseline", false, runs_here, gather, press, scatter};
