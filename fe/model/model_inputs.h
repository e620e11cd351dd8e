/* All inputs that determine the results of a model: the values its files resolve to, not their
 * texts. A dataset keeps them as `inputs`; a dataset with other inputs is outdated, and the
 * first difference is reported. Names, titles, notes and sources are not inputs.
 *
 * The functions set members of an object, under the keys and in the units of the model's files.
 */
#ifndef WB_FE_MODEL_MODEL_INPUTS_H
#define WB_FE_MODEL_MODEL_INPUTS_H

#include <stdbool.h>

#include "base/hash.h"
#include "base/json.h"
#include "fe/material/law.h"
#include "fe/model/bundle_model.h"
#include "fe/model/wire_model.h"

/* The law of a beam's section. */
void wb_model_inputs_law(struct wb_json *object, const struct wb_law *law);

/* Of a bundle with a mesh in explicit dynamics; without one (NULL) in the section model. */
void wb_model_inputs_bundle(struct wb_json *object, const struct wb_bundle_model *model,
                            const struct wb_bundle_mesh *mesh);

/* Of a wire as a solid, or as a rod, which has no mesh of its own. */
void wb_model_inputs_wire(struct wb_json *object, const struct wb_wire_model *model, bool is_solid);

/* SHA-256 of the inputs' text. */
void wb_model_inputs_sum(const struct wb_json *object, char sha256[WB_SHA256_TEXT]);

#endif
