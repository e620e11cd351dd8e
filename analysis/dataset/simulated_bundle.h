/* A computed bundle (fe/bundle/bundle_run.h) as a dataset, and its energies beside it.
 *
 * energies.csv in the dataset's folder has one row for each of force_deflection.csv:
 *
 *     t_s,deflection_mm,model_time_s,external_J,kinetic_J,stored_J,plastic_J,contact_J,cohesive_J,
 *     friction_J,artificial_J,kinetic_over_internal,artificial_over_internal,imbalance_J
 *
 * (one line). Internal energy is stored + plastic + contact + cohesive; ratios are empty where it
 * is zero.
 */
#ifndef WB_ANALYSIS_DATASET_SIMULATED_BUNDLE_H
#define WB_ANALYSIS_DATASET_SIMULATED_BUNDLE_H

#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "base/hash.h"
#include "base/status.h"
#include "fe/bundle/bundle_run.h"
#include "fe/model/bundle_model.h"
#include "fe/model/bundle_override.h"

/* Sets the `inputs` of dataset.json: everything that decides the numbers of a dataset, with the
 * solver and its version. Mesh NULL: the section model. */
void wb_simulated_bundle_inputs(struct wb_json *object, const struct wb_bundle_model *model,
                                const struct wb_bundle_mesh *mesh);

/* SHA-256 of these inputs. */
void wb_simulated_bundle_sum(const struct wb_bundle_model *model, const struct wb_bundle_mesh *mesh,
                             char sha256[WB_SHA256_TEXT]);

struct wb_simulated_bundle {
    const struct wb_bundle_model *model; /* as computed, with overridden settings */
    const struct wb_bundle_mesh *mesh;
    const struct wb_bundle_result *result;
    const struct wb_bundle_override *override; /* overridden settings; NULL: none */
    double surface_deflection;                 /* m, of surface.csv; 0: there is none */
    double wall, cpu;                          /* s */
};

/* Description of a bundle in dataset.json that does not depend on the solver. */
struct wb_simulated_bundle_head {
    const char *name;                          /* after the bundle's: "simulated bundle" */
    const struct wb_bundle_model *model;       /* as computed */
    const struct wb_bundle_mesh *mesh;         /* NULL: the section model */
    const struct wb_bundle_override *override; /* NULL: nothing */
    bool is_complete;
};

/* Keys of `simulation`: those that do not depend on the solver, and those of explicit dynamics. */
extern const struct wb_keys wb_simulated_bundle_head_keys, wb_simulated_bundle_keys;

/* Sets `info` and begins dataset.json; returns its `simulation` for further members. */
struct wb_json *wb_simulated_bundle_begin(struct wb_dataset *dataset,
                                          const struct wb_simulated_bundle_head *head);

/* Fills an initialised dataset with the test of the homogenised beam: the outer diameter is the
 * published one where the model has it, otherwise that of wires and tape; Poisson's ratio is 0.3.
 * The bench time assumes a tip speed of 1 mm/s, at least 1 ms a row. */
void wb_simulated_bundle_fill(struct wb_dataset *dataset, const struct wb_simulated_bundle *bundle);

/* Writes energies.csv into the folder of the dataset that was filled from the same bundle. */
WB_MUST_CHECK enum wb_status
wb_simulated_bundle_write_energies(const struct wb_dataset *dataset,
                                   const struct wb_simulated_bundle *bundle, const char *folder);

/* Numbers of a run for `simulation` and for --json of the command: mesh, elements, steps,
 * durations, energies at the end, largest ratios, times. */
void wb_simulated_bundle_describe(struct wb_json *object, const struct wb_simulated_bundle *bundle);

#endif
