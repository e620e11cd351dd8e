/* What tests of fe/rod/fibres.h ask beside it. */
#ifndef WB_FE_ROD_FIBRES_PRIVATE_H
#define WB_FE_ROD_FIBRES_PRIVATE_H

#include "fe/rod/fibres.h"

/* From now on responses are computed without the processor's vector instructions: by the same
 * source, to the same bits. Histories stay valid. */
void wb_fibres_set_portable(struct wb_fibres *fibres);

/* The largest accumulated plastic strain of a point's fibres, 0 when it never yielded. */
double wb_fibres_largest_plastic_strain(const struct wb_fibres *fibres, const double *history);

#endif
