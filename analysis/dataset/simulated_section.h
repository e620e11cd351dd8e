/* A bundle computed by the section model (fe/section/section_run.h) as a dataset: rows and shapes
 * like those of the explicit model (analysis/dataset/simulated_bundle.h), `model` "section", and
 * energies of its own:
 *
 *     t_s,deflection_mm,external_J,wires_J,tape_J,cohesive_J,friction_J,imbalance_J
 *
 * in energies.csv; those of wires and tape are stored and plastic work together.
 */
#ifndef WB_ANALYSIS_DATASET_SIMULATED_SECTION_H
#define WB_ANALYSIS_DATASET_SIMULATED_SECTION_H

#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "base/json.h"
#include "base/status.h"
#include "fe/model/bundle_override.h"
#include "fe/section/section_run.h"

struct wb_simulated_section {
    const struct wb_bundle_model *model; /* as computed, with overridden settings */
    const struct wb_section_run *run;
    const struct wb_bundle_override *override; /* NULL: nothing */
    double wall, cpu;                          /* s */
};

/* Fills an initialised dataset with the test of the homogenised beam, as for an explicit bundle. */
void wb_simulated_section_fill(struct wb_dataset *dataset,
                               const struct wb_simulated_section *section);

/* Writes energies.csv into the folder of the dataset that was filled from the same run. */
WB_MUST_CHECK enum wb_status
wb_simulated_section_write_energies(const struct wb_dataset *dataset,
                                    const struct wb_simulated_section *section, const char *folder);

/* Its keys of `simulation` after those of the head (analysis/dataset/simulated_bundle.h). */
extern const struct wb_keys wb_simulated_section_keys;

/* Numbers of a run for `simulation` and for --json of the command. */
void wb_simulated_section_describe(struct wb_json *object,
                                   const struct wb_simulated_section *section);

#endif
