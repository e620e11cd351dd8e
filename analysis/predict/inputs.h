/* Uncertain inputs of a bundle, as numbers between 0 and 1: from the section `uncertainty` of its
 * file, and the specimens of the properties files that it names. Groups of inputs are drawn
 * independently. */
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

/* Distribution of the law of one type of wires: drawn from specimens, or tolerances about a law. */
struct wb_inputs_wires {
    bool from_specimens;
    struct wb_specimens specimens;
    double mean[WB_SPECIMENS_QUANTITIES]; /* of a law without specimens */
    double tolerance[3];                  /* of E, sigma_Y, stresses beyond yield */
    double isotropic_share;               /* beta of the hardening rule, */
    bool is_combined;                     /* which is combined hardening; else mixed */
    char source[WB_INPUTS_NAME];          /* description for output */
};

struct wb_inputs {
    struct wb_bundle_uncertainty uncertainty;
    int n_types;
    struct wb_inputs_wires wires[WB_BUNDLE_MODEL_TYPES];
    int n_dimensions; /* numbers of a run */
    int n_columns;    /* inputs of a run, as values */
    int group[WB_RANKING_COLUMNS];
    int n_groups;
    char group_name[WB_RANKING_GROUPS][WB_INPUTS_NAME];
};

/* Lists the inputs of a model. Fails with WB_ERR_ARGUMENT if an uncertainty is missing; the message
 * says what to add to the file. */
WB_MUST_CHECK enum wb_status wb_inputs_init(struct wb_inputs *inputs,
                                            const struct wb_bundle_model *model);

/* Applies the inputs of a run to a model (or a variant of it), u (n_dimensions) within (0, 1);
 * `values` (n_columns; may be NULL) receives the inputs. False if the draw of a law had to be
 * limited. */
bool wb_inputs_apply(const struct wb_inputs *inputs, const double *u, struct wb_bundle_model *model,
                     double *values);

#endif
