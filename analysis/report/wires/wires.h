/* A comparison campaign: one wire computed as a 3D solid and as a 1D rod, elastic and
 * elastoplastic, without and with residual stresses, after section 2 of the paper. Computing a
 * solid takes minutes, so the campaign names datasets that `wirebench solve` made from its models.
 * Its YAML file:
 *
 *     kind: comparison
 *     title: A wire as a solid and as a rod
 *     notes: what a reader should know            # optional
 *     simulations: ../../simulations              # optional, the shipped ones by default
 *     elastic: {model: follower-8awg-elastic}     # name in fixtures/models, or a path
 *     contact:                                    # optional; the solid only
 *       model: follower-8awg-elastic-contact
 *     elastoplastic:
 *       model: follower-8awg
 *       solid: my-solid                           # optional: MODEL-3d and MODEL-1d; names in
 *       rod: ../my-rod                            # `simulations`, with a '/' paths from this file
 *     residual:                                   # optional, at most four
 *       - {label: Residual 1, model: residual-1-8awg}
 *     section_mm: 3.26                            # optional: whose stresses are drawn; the core's
 *                                                 # diameter by default
 *     states: {loaded: loaded, residual: unloaded}    # optional: steps at whose end fields are
 *     fit_modulus: mixture                        # optional: E of eq. 8, or `curve`: of eq. 10
 *     fit: {step_mm: 0.5}                         # optional, as a campaign's `settings`
 *     limits:                                     # optional, absent: none
 *       tip_max: 0.003                            # elastic tips from the exact one
 *       stress_max: 0.01                          # elastic stress from E kappa r
 *       cost_max: 0.02                            # CPU seconds of the rod over the solid's
 *     printed:                                    # optional: the paper's own values
 *       source: section 2 of the paper
 *       wire: 8awg                                # its homogenised properties
 *       stress_MPa: 697
 *       cost: 0.02
 *
 * A dataset that is not there is no error: the report says so, and how to make it.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_H

#include <stdbool.h>

#include "analysis/report/campaign.h"
#include "analysis/report/simulation.h"
#include "base/status.h"
#include "fe/model/wire.h"
#include "fe/model/wire_model.h"

#define WB_WIRES_RESIDUALS 4

/* Solver of a model. */
enum wb_wires_solver {
    WB_WIRES_SOLID, /* solve wire3d */
    WB_WIRES_ROD,   /* solve wire1d */
    WB_WIRES_SOLVERS
};
const char *wb_wires_command(enum wb_wires_solver solver); /* "wire3d", "wire1d" */

/* A model with its datasets. */
struct wb_wires_case {
    char label[64];
    char model_name[300];        /* as commands show it */
    struct wb_wire_model *model; /* owned */
    struct wb_simulation datasets[WB_WIRES_SOLVERS];
};

/* Indices of the cases; those of residual stresses follow. */
enum {
    WB_WIRES_ELASTIC,
    WB_WIRES_CONTACT, /* `model` NULL: not wanted */
    WB_WIRES_ELASTOPLASTIC,
    WB_WIRES_RESIDUAL,
    WB_WIRES_CASES = WB_WIRES_RESIDUAL + WB_WIRES_RESIDUALS
};

struct wb_wires {
    struct wb_campaign head;
    int n_cases, n_residual;
    struct wb_wires_case cases[WB_WIRES_CASES];
    double section;                            /* m */
    char loaded_state[32], residual_state[32]; /* names of steps */
    bool mixture;                              /* E of eq. 8 for the fit */
    double tip_limit; /* distance over the exact tip's displacement, 1; 0: none, as all of them */
    double stress_limit; /* of the ratio from 1 */
    double cost_limit;   /* 1 */
    char printed_source[160];
    bool has_printed_wire;
    struct wb_wire printed_wire;
    double printed_stress; /* Pa; 0: none */
    double printed_cost;   /* 1; 0: none */
};

/* Reading and release, as wb_kind_keys and wb_kind_release have it. */
WB_MUST_CHECK enum wb_status wb_wires_keys(void *context, const struct wb_config_node *root);
void wb_wires_release(void *context);

/* The follower force at the end of a model's last step, N. */
double wb_wires_force(const struct wb_wire_model *model);

/* Whether a material of the elastoplastic solid stands in for one that the paper lost. */
bool wb_wires_has_substitutes(const struct wb_wires *comparison);

#endif
