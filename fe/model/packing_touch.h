/* Places of wires as read off a photograph, put right: wires that lie side by side in the picture
 * touch, though places are read with errors of some hundredths of a millimetre. */
#ifndef WB_FE_MODEL_PACKING_TOUCH_H
#define WB_FE_MODEL_PACKING_TOUCH_H

#include "base/reason.h"
#include "base/status.h"
#include "fe/model/packing.h"

/* Moves the wires as little as needed (least squares) until every two of them whose gap is at most
 * `reach` (m, either way) touch, to round-off. Which wires touch stays as it is read, unlike with
 * wb_packing_settle(), which looks for a smaller circle round them. A WB_ERR_ARGUMENT that names
 * the wires where two overlap by more than `reach`, or cannot touch with the others as they are;
 * then `packing` is as before. */
WB_MUST_CHECK enum wb_status wb_packing_touch(struct wb_packing *packing, double reach,
                                              struct wb_reason *why);

#endif
