#include "fe/swept/swept_tape_contact_kernel.inc"

const struct wb_swept_tape_contact_kernel wb_swept_tape_contact_kernel_float_baseline = {
    "baseline", false, add_forces};
