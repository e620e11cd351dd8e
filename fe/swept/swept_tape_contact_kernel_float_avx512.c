#include "fe/swept/swept_tape_contact_kernel.inc"

const struct wb_swept_tape_contact_kernel wb_swept_tape_contact_kernel_float_avx512 = {
    "avx512", false, add_forces};
