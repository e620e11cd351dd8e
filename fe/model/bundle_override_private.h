/* Functions for the tests of fe/model/bundle_override.h. */
#ifndef WB_FE_MODEL_BUNDLE_OVERRIDE_PRIVATE_H
#define WB_FE_MODEL_BUNDLE_OVERRIDE_PRIVATE_H

#include "fe/model/bundle_override.h"

/* Applies an override, except packing and tape, to a model that was read; on failure the model is
 * unchanged. */
WB_MUST_CHECK enum wb_status wb_bundle_override_apply(const struct wb_bundle_override *override,
                                                      struct wb_bundle_model *model);

#endif
