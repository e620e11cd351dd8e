#define REAL_IS_DOUBLE

#include "fe/swept/swept_tape_contact_kernel.inc"

const struct wb_swept_tape_contact_kernel wb_swept_tape_contact_kernel_double_avx2 = {"avx2", true,
                                                                                      add_forces};
