/* What tests of fe/model/bundle_override.h ask beside it. */
#ifndef WB_FE_MODEL_BUNDLE_OVERRIDE_PRIVATE_H
#define WB_FE_MODEL_BUNDLE_OVERRIDE_PRIVATE_H

#include "fe/model/bundle_override.h"

/* Changes a model that was read, in all but packing and tape; it is as it was on failure. */
WB_MUST_CHECK enum wb_status wb_bundle_override_apply(const struct wb_bundle_override *override,
                                                      struct wb_bundle_model *model);

#endif
