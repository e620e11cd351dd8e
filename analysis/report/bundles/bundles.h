/* A campaign of taped bundles, after section 5 of the paper: bundles computed in explicit 3D
 * (`wirebench solve bundle`), studies of friction and cohesion, and the homogenised 1D beam fitted
 * to each of them. Its YAML file:
 *
 *     kind: bundles
 *     title: Taped bundles in 3D and in 1D
 *     notes: what a reader should know            # optional
 *     simulations: ../../simulations              # optional, the shipped ones by default
 *     defaults: {dead_force: true, weight: false} # optional: of all runs, any key below but `name`
 *     runs:                                       # and `bundle`
 *       - name: 7-type3-dynamic                   # of its dataset in `simulations`
 *         bundle: 7-type3                         # name in fixtures/bundles, or a path
 *         label: 7 wires, decaying friction       # optional, its settings by default
 *         friction: 0.4                           # these and the rest: the bundle's by default;
 *                                                 # or {static: 0.4, kinetic: 0.1, decay_s_mm: 2}
 *         cohesive_stiffness_N_mm3: 30
 *         dead_force: true                        # a vertical force in place of the strand
 *         weight: false
 *         mesh: engineering
 *         mass_scaling: 25
 *         selective_mass_scaling: 100
 *         duration_s: 3
 *     groups:                                     # at most three bundles stand in one figure
 *       - label: 7, 12 and 19 wires of type 3
 *         figures: {section: 17, force: 19, error: 20, shape: 21, energy: 22}    # optional: the
 *         bundles:                                # paper's own
 *           - label: 7 wires
 *             dynamic: 7-type3-dynamic            # run with decaying friction, which is fitted
 *             constant: 7-type3-constant          # optional: run with constant friction
 *             rod: bundle-7-1d                    # optional: dataset of `wirebench solve
 *                                                 # cantilever` with the published properties
 *     studies:                                    # optional
 *       - {title: Friction, runs: [a, b], labels: [low, high]}   # labels: the runs' by default
 *     inset: 7 wires                              # optional: the bundle whose shape is drawn
 *     fit: {yield_point: 0.04}                    # optional, as a campaign's `settings`
 *     limits:                                     # optional, absent: none
 *       rms_max: 0.065                            # decaying friction from the published curve
 *       kinetic_max: 0.05                         # over internal energy, from 2 mm on
 *       artificial_max: 0.05                      # the same of artificial energy
 *       imbalance_max: 0.01                       # of energy, over the external work
 *       cost_max: 0.005                           # CPU seconds of the 1D beam over the bundle's
 *     printed:                                    # optional: what the paper prints
 *       source: section 5 of the paper
 *       rms: [2.45e-2, 6.53e-2]
 *       cost: 0.005
 *
 * A dataset that is not there is no error: the report says so, and how to make it.
 */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_H

#include <stdbool.h>

#include "analysis/report/campaign.h"
#include "analysis/report/draw/figures_bundle.h"
#include "analysis/report/simulation.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"

enum {
    WB_BUNDLES_RUNS = 64,
    WB_BUNDLES_GROUPS = 8,
    WB_BUNDLES_BUNDLES = WB_BUNDLES_GROUPS * WB_FIGURES_BUNDLE_MOST,
    WB_BUNDLES_STUDIES = 12,
    WB_BUNDLES_STUDY_RUNS = 8
};

/* A bundle as one run computes it. */
struct wb_bundles_run {
    char name[128], label[160];    /* label: plain text */
    char model_name[300];          /* as commands show it */
    struct wb_bundle_model *model; /* with the run's own settings; owned */
    const struct wb_bundle_mesh *mesh;
    struct wb_simulation dataset;
    bool judged; /* the limits of energies apply to it */
};

/* A bundle with its runs (index of them; -1: none). */
struct wb_bundles_bundle {
    char label[64];
    int group;
    int dynamic, constant;
    bool has_rod;
    struct wb_simulation rod;
};

enum wb_bundles_figure {
    WB_BUNDLES_SECTION,
    WB_BUNDLES_FORCE,
    WB_BUNDLES_ERROR,
    WB_BUNDLES_SHAPE,
    WB_BUNDLES_ENERGY,
    WB_BUNDLES_FIGURES
};

struct wb_bundles_group {
    char label[160];
    char figures[WB_BUNDLES_FIGURES][16]; /* the paper's numbers; "": none */
    int first, n;                         /* of the bundles */
};

struct wb_bundles_study {
    char title[160];
    int n;
    int runs[WB_BUNDLES_STUDY_RUNS];
    char labels[WB_BUNDLES_STUDY_RUNS][160]; /* plain text */
};

/* Of ratios, 1; 0: none. */
struct wb_bundles_limits {
    double rms, kinetic, artificial, imbalance, cost;
};

struct wb_bundles {
    struct wb_campaign head;
    int n_runs, n_groups, n_bundles, n_studies;
    struct wb_bundles_run runs[WB_BUNDLES_RUNS];
    struct wb_bundles_group groups[WB_BUNDLES_GROUPS];
    struct wb_bundles_bundle bundles[WB_BUNDLES_BUNDLES]; /* in the order of the groups */
    struct wb_bundles_study studies[WB_BUNDLES_STUDIES];
    int inset; /* bundle; -1: none */
    struct wb_bundles_limits limits;
    char printed_source[160];
    double printed_rms[2]; /* range; 0: none */
    double printed_cost;   /* 0: none */
};

/* Reading and release, as wb_kind_keys and wb_kind_release have it. */
WB_MUST_CHECK enum wb_status wb_bundles_keys(void *context, const struct wb_config_node *root);
void wb_bundles_release(void *context);

/* The homogenised beam that is published of a run's bundle, with its properties; NULL: none. */
const struct wb_wire *wb_bundles_published(const struct wb_bundles_run *run);

/* How a run is loaded, for readers: "dead force", "strand, weight". */
const char *wb_bundles_loading(const struct wb_bundles_run *run);

#endif
