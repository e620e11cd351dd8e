/* Uncertainty of a bundle: the section `uncertainty` of its file (fe/model/bundle_model.h), from
 * which `wirebench solve bundle --uncertain` computes bands. The keys are in
 * docs/file-formats.md.
 *
 *     uncertainty:
 *       wires:
 *         - {wire: type3, properties: type3-properties.yaml}   # as calibrate writes it
 *         - {wire: type2, youngs_modulus_percent: 5, yield_stress_percent: 10, stress_percent: 5}
 *       diameter_percent: 1
 *       pitch_percent: 1
 *       length_percent: 0.5
 *       tape: {thickness_percent: 5, youngs_modulus_percent: 10, yield_stress_percent: 10}
 *       cohesive_stiffness_N_mm3: [15, 60]
 *       friction: [0.1, 0.4]
 *       scenarios:
 *         - {name: one-layer, layers: 1}
 *
 * A tolerance is half the width of an even distribution, relative to the file's value. Ranges are
 * even in the logarithm. 0, or a range of one value, is exact.
 */
#ifndef WB_FE_MODEL_BUNDLE_UNCERTAINTY_H
#define WB_FE_MODEL_BUNDLE_UNCERTAINTY_H

#include <stdbool.h>

#include "base/config.h"
#include "base/file.h"
#include "base/status.h"

enum {
    WB_BUNDLE_UNCERTAINTY_WIRES = 16,
    WB_BUNDLE_UNCERTAINTY_SCENARIOS = 8
};

/* Values of a scenario that replace the file's; a zeroed struct changes nothing. */
struct wb_bundle_variant {
    char name[64];
    int wires;        /* number of wires, of a file with one kind of wire; 0: the file's */
    bool has_packing; /* false: another number of wires is packed as a hexagon or triangle where it
                         fills one, else densest */
    int packing;      /* enum wb_bundle_packing, but no places */
    int layers;       /* of the tape; 0: the file's */
    double lap; /* part of a winding that the next winding covers: the tape is 1/(1 - lap) times as
                   thick as its layers */
    bool has_outline;
    int outline; /* 0 hull, 1 circle */
    bool has_reach;
    double reach; /* m, of bonds */
};

/* Of the wires of one kind: properties with specimens, or tolerances. */
struct wb_bundle_spread {
    char wire[64];
    char properties[WB_PATH]; /* path; "": none */
    bool has_tolerances;
    double youngs_modulus, yield_stress, stress; /* 1; `stress`: of all stress beyond yield */
    int line;                                    /* of the file, for messages */
};

struct wb_bundle_uncertainty {
    int n_wires;
    struct wb_bundle_spread wire[WB_BUNDLE_UNCERTAINTY_WIRES];
    double diameter; /* 1, of all wires, which remain in contact */
    double pitch;  /* 1, of the distances between wires and of the tape's distance from the axis */
    double length; /* 1 */
    bool has_tape; /* the next three were stated */
    double tape_thickness, tape_modulus, tape_yield_stress; /* 1 */
    bool has_cohesion;
    double cohesion[2]; /* K_cc, Pa/m: least, largest */
    bool has_friction;
    double friction[2]; /* mu between wires, constant: least, largest */
    int n_scenarios;
    struct wb_bundle_variant scenario[WB_BUNDLE_UNCERTAINTY_SCENARIOS];
};

/* Names of the tape's outlines, in the order of `outline` above, then NULL. */
extern const char *const wb_bundle_uncertainty_outlines[];

/* Reads the section of a file into a zeroed struct. Paths of properties are relative to the file's
 * folder. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_bundle_uncertainty_read(struct wb_bundle_uncertainty *uncertainty,
                                                        const struct wb_config_node *map);

#endif
