/* Values of a run that replace those of its bundle file (fe/model/bundle_model.h).
 *
 * A zeroed struct changes nothing. Rows and ranges of the settings are those of the file.
 */
#ifndef WB_FE_MODEL_BUNDLE_OVERRIDE_H
#define WB_FE_MODEL_BUNDLE_OVERRIDE_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/model/bundle_model.h"

struct wb_bundle_override {
    /* Of the piece; 0: the file's. */
    double length; /* m */
    int packing;   /* 1 and enum wb_bundle_packing, but no places */
    int layers;    /* of the tape's sleeve */
    int outline;   /* of the tape: 1 hull, 2 circle */
    struct {
        bool is_given;
        double reach; /* m */
    } bond;
    bool dead_force; /* a vertical force at the tip, no strand */
    bool no_weight;
    struct wb_bundle_run run;             /* but the limit of kinetic energy and the precision; ""
                                             and 0: the file's */
    struct wb_bundle_interface interface; /* of it the friction if has_friction, and the normal
                                             stiffness, with which the shear stiffness keeps its
                                             ratio; 0: the file's */
};

/* The tables of all settings, in the order of a dataset's document. */
enum {
    WB_BUNDLE_OVERRIDE_MESH,
    WB_BUNDLE_OVERRIDE_PIECE, /* of struct wb_bundle_override itself, and the cycles */
    WB_BUNDLE_OVERRIDE_TEST,  /* deflection and rows */
    WB_BUNDLE_OVERRIDE_LOADS, /* of struct wb_bundle_override itself */
    WB_BUNDLE_OVERRIDE_RUN,   /* in time: duration and masses */
    WB_BUNDLE_OVERRIDE_FRICTION,
    WB_BUNDLE_OVERRIDE_COHESION,
    WB_BUNDLE_OVERRIDE_TABLES /* how many */
};
extern const struct wb_setting_table wb_bundle_override_tables[WB_BUNDLE_OVERRIDE_TABLES];

/* Whether the override changes nothing. */
bool wb_bundle_override_is_empty(const struct wb_bundle_override *override);

/* Reads a bundle as wb_bundle_model_read_variant() does, with the override's values in place of the
 * file's. The variant has precedence. NULL: no override, no variant. WB_ERR_ARGUMENT for a mesh
 * that the bundle does not have, for values out of range or in conflict, and for a stiffness with
 * which the interface's damage would not soften. */
WB_MUST_CHECK enum wb_status wb_bundle_override_read(struct wb_bundle_model *model,
                                                     const char *path,
                                                     const struct wb_bundle_override *override,
                                                     const struct wb_bundle_variant *variant);

#endif
