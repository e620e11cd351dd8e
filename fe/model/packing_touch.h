/* Corrects positions of wires that were read from a photograph: wires that are neighbours in the
 * picture touch, although positions are read with errors of some hundredths of a millimetre. */
#ifndef WB_FE_MODEL_PACKING_TOUCH_H
#define WB_FE_MODEL_PACKING_TOUCH_H

#include "base/reason.h"
#include "base/status.h"
#include "fe/model/packing.h"

/* Moves the wires as little as possible (least squares) until every two wires whose gap or overlap
 * is at most `reach` (m) touch, to round-off. The contacts stay as read, unlike with
 * wb_packing_settle(), which searches for a smaller enclosing circle. WB_ERR_ARGUMENT, naming the
 * wires, where two overlap by more than `reach` or cannot touch together with the others; then
 * `packing` is unchanged. */
WB_MUST_CHECK enum wb_status wb_packing_touch(struct wb_packing *packing, double reach,
                                              struct wb_reason *why);

#endif
