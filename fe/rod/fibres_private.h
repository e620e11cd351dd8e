/* What tests of fe/rod/fibres.h ask beside it. */
#ifndef WB_FE_ROD_FIBRES_PRIVATE_H
#define WB_FE_ROD_FIBRES_PRIVATE_H

#include "fe/rod/fibres.h"

/* From now on responses are computed without the vector instructions that the processor has: by the
 * same source, to the same bits. A history goes on. */
void wb_fibres_set_portable(struct wb_fibres *fibres);

#endif
