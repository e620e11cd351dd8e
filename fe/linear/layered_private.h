/* Functions of fe/linear/layered.c that only tests use. */
#ifndef WB_FE_LINEAR_LAYERED_PRIVATE_H
#define WB_FE_LINEAR_LAYERED_PRIVATE_H

#include <stddef.h>

#include "fe/linear/layered.h"

/* Memory of the blocks, bytes. */
size_t wb_layered_memory(const struct wb_layered *layered);

/* Floating-point operations of one factorisation. */
double wb_layered_operations(const struct wb_layered *layered);

#endif
