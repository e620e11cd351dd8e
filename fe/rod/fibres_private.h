/* Functions of fe/rod/fibres.c that only tests use. */
#ifndef WB_FE_ROD_FIBRES_PRIVATE_H
#define WB_FE_ROD_FIBRES_PRIVATE_H

#include "fe/rod/fibres.h"

/* Computes all following responses without the processor's vector instructions: same source,
 * identical bits. Histories stay valid. */
void wb_fibres_set_portable(struct wb_fibres *fibres);

/* Largest accumulated plastic strain of a point's fibres; 0 if it never yielded. */
double wb_fibres_largest_plastic_strain(const struct wb_fibres *fibres, const double *history);

#endif
