#define REAL_IS_DOUBLE

#include "fe/swept/swept_tape_contact_kernel.inc"

const struct wb_swept_tape_contact_kernel wb_swept_tape_contact_kernel_double_baseline = {
    "baseline", true, add_forces};
