/* Functions of fe/solid/hex20_kernel.c that only tests use. */
#ifndef WB_FE_SOLID_HEX20_KERNEL_PRIVATE_H
#define WB_FE_SOLID_HEX20_KERNEL_PRIVATE_H

#include "fe/solid/hex20_kernel.h"

/* Computes the product with a given instruction set; false if the processor does not have it. */
enum wb_hex20_kernel_variant {
    WB_HEX20_KERNEL_PORTABLE,
    WB_HEX20_KERNEL_AVX2,
    WB_HEX20_KERNEL_AVX512
};
bool wb_hex20_kernel_multiply_by(enum wb_hex20_kernel_variant variant,
                                 const struct wb_hex20_kernel *kernel, double *restrict stiffness);

#endif
