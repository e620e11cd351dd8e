/* What tests of fe/solid/hex20_kernel.h ask beside it. */
#ifndef WB_FE_SOLID_HEX20_KERNEL_PRIVATE_H
#define WB_FE_SOLID_HEX20_KERNEL_PRIVATE_H

#include "fe/solid/hex20_kernel.h"

/* By a given way; false where the processor does not have it. */
enum wb_hex20_kernel_way {
    WB_HEX20_KERNEL_PORTABLE,
    WB_HEX20_KERNEL_AVX2,
    WB_HEX20_KERNEL_AVX512
};
bool wb_hex20_kernel_multiply_by(enum wb_hex20_kernel_way way, const struct wb_hex20_kernel *kernel,
                                 double *restrict stiffness);

#endif
