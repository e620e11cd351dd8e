/* Functions of base/interrupt.c that only tests use. */
#ifndef WB_BASE_INTERRUPT_PRIVATE_H
#define WB_BASE_INTERRUPT_PRIVATE_H

#include "base/interrupt.h"

/* Sets or clears the flag without a signal (tests, a stop key). */
void wb_interrupt_set(bool interrupted);

#endif
