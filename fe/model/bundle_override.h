/* What a run has in place of values of its bundle's file (fe/model/bundle_model.h).
 *
 * A zeroed one changes nothing. Ranges are those of the file: friction coefficients 0 to 10, the
 * kinetic one at most the static one; stiffness, duration and decay above 0; factors at least 1.
 */
#ifndef WB_FE_MODEL_BUNDLE_OVERRIDE_H
#define WB_FE_MODEL_BUNDLE_OVERRIDE_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/model/bundle_model.h"

struct wb_bundle_override {
    const char *mesh; /* name, borrowed; NULL: the file's, as 0 below */
    bool dead_force;  /* a vertical force at the tip, no strand */
    bool no_weight;
    double duration;                /* s, of a loading */
    double mass_scaling, selective; /* f_m and beta */
    bool has_friction;              /* these three, between all that touches */
    double friction_static;         /* 1 */
    double friction_kinetic;        /* 1 */
    double friction_decay;          /* s/m; 0: the static one at any rate */
    double cohesive_stiffness;      /* Pa/m, normal; the shear stiffness keeps its ratio */
};

/* Whether it changes anything. */
bool wb_bundle_override_is_empty(const struct wb_bundle_override *override);

/* Changes the model; it is as it was on failure. WB_ERR_NOT_FOUND when it has no such mesh,
 * WB_ERR_ARGUMENT for values out of range, also for a stiffness with which the interface's damage
 * would not soften. */
WB_MUST_CHECK enum wb_status wb_bundle_override_apply(const struct wb_bundle_override *override,
                                                      struct wb_bundle_model *model);

#endif
