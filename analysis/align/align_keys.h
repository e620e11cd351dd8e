/* Keys of the dataset of a recording. */
#ifndef WB_ANALYSIS_ALIGN_ALIGN_KEYS_H
#define WB_ANALYSIS_ALIGN_ALIGN_KEYS_H

#include "analysis/keys/keys.h"

extern const struct wb_keys wb_align_document_keys; /* of its root */

/* Parts that reports copy. */
extern const struct wb_keys wb_align_correction_keys, wb_align_checks_keys;

#endif
