/* What is uncertain of a bundle, as numbers between 0 and 1: the section `uncertainty` of its file,
 * with the specimens of the properties that it names. Groups of inputs are drawn independently.
 */
#ifndef WB_ANALYSIS_PREDICT_INPUTS_H
#define WB_ANALYSIS_PREDICT_INPUTS_H

#include <stdbool.h>

#include "analysis/predict/ranking.h"
#include "analysis/predict/specimens.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"

enum {
    WB_INPUTS_NAME = 96
};

/* The law of the wires of one type: draws from specimens, or tolerances about a law. */
struct wb_inputs_wires {
    bool from_specimens;
    struct wb_specimens specimens;
    double mean[WB_SPECIMENS_QUANTITIES]; /* of a law without specimens */
    double tolerance[3];                  /* of E, sigma_Y, stresses beyond yield */
    double isotropic_share;               /* of the hardening rule, */
    bool is_combined;                     /* which is combined; else mixed */
    char source[WB_INPUTS_NAME];          /* for people */
};

struct wb_inputs {
    struct wb_bundle_uncertainty uncertainty;
    int n_types;
    struct wb_inputs_wires wires[WB_BUNDLE_MODEL_TYPES];
    int n_dimensions; /* numbers of a run */
    int n_columns;    /* inputs of a run as values */
    int group[WB_RANKING_COLUMNS];
    int n_groups;
    char group_name[WB_RANKING_GROUPS][WB_INPUTS_NAME];
};

/* Of a model that was read. Refuses what is not stated, with what to add to the file. */
WB_MUST_CHECK enum wb_status wb_inputs_init(struct wb_inputs *inputs,
                                            const struct wb_bundle_model *model);

/* Changes a model (or a variant of it) to that of a run, u (n_dimensions) within (0, 1); `values`
 * (n_columns; NULL: not wanted) receives the inputs. False where a draw of a law had to be limited.
 */
bool wb_inputs_apply(const struct wb_inputs *inputs, const double *u, struct wb_bundle_model *model,
                     double *values);

#endif
