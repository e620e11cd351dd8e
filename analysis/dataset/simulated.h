/* A simulated test as a dataset: the same rows and shapes as a measured one.
 *
 * Bench time is the time in which a stage at 1 mm/s would have made the way. Shapes hold as many
 * equally spaced positions as the computation recorded, as if they were markers.
 */
#ifndef WB_ANALYSIS_DATASET_SIMULATED_H
#define WB_ANALYSIS_DATASET_SIMULATED_H

#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "base/text.h"
#include "fe/material/law.h"
#include "fe/model/wire_model.h"
#include "fe/trial/loading_steps.h"
#include "fe/trial/three_point_bending.h"
#include "fe/trial/wire3d.h"
#include "fe/trial/wire_run.h"

/* Everything that decides the numbers of a cantilever test. */
struct wb_simulated_cantilever {
    const struct wb_law *law;
    double outer_diameter, length, deflection; /* m */
    double strand_length;                      /* m; 0: a vertical force */
    double mass_per_length;                    /* kg/m; 0: no weight */
    int points, cycles;
};

/* Origin of the simulation, for dataset.json. */
struct wb_simulated_origin {
    const char *model;        /* "cantilever" */
    const char *source;       /* where the properties come from */
    const struct wb_law *law; /* an elastic one: Ludwik's form of an elastic material */
    double wall, cpu;         /* s */
    const struct wb_simulated_cantilever *cantilever; /* NULL: another solver */
};

/* The rows of a three-point bending test. */
struct wb_simulated_bending {
    int n_rows;
    const struct wb_simulated_bending_row {
        int cycle;
        enum wb_phase phase;
        struct wb_three_point_bending_point point;
    } * rows; /* (n_rows) */
    bool converged;
};

/* Fills an initialised dataset. `shape_s` are the arc lengths of the plan, m. */
void wb_simulated_fill(struct wb_dataset *dataset, const struct wb_test_info *info,
                       const struct wb_loading_steps *loading, const double *shape_s,
                       const struct wb_simulated_origin *origin);

/* The same for three-point bending: `info` is of that kind, with its machine; `deflection` of a row
 * is the travel. */
void wb_simulated_fill_three_point(struct wb_dataset *dataset, const struct wb_test_info *info,
                                   const struct wb_simulated_bending *bending,
                                   const struct wb_simulated_origin *origin);

/* Shapes in space of all rows, one after another: n places (m) at the arc lengths s (m) each. */
struct wb_simulated_shapes {
    int n;
    const double *s;
    double (*places)[3];
};

/* Appends a row of a free tip at a place (m), and its shape as that of n markers. The bench time of
 * the row is that of the row before plus the tip's path from `before` (NULL: first row) at 1 mm/s,
 * at least 1 ms. Sets time and tip_x of the row. */
void wb_simulated_add_row(struct wb_dataset *dataset, struct wb_row row, const double *before,
                          const double *tip, const struct wb_simulated_shapes *shapes);

/* Appends a row of energies.csv: time, deflection (in mm), and energies and ratios, empty where
 * they are not finite. */
void wb_simulated_append_energies(struct wb_text *text, const double *columns, size_t n);

/* Set the `inputs` of dataset.json: everything that decides the dataset's numbers, with the solver
 * and its version. */
void wb_simulated_cantilever_inputs(struct wb_json *object,
                                    const struct wb_simulated_cantilever *cantilever);
void wb_simulated_wire_inputs(struct wb_json *object, const struct wb_wire_model *model,
                              bool is_solid);

/* Keys of `simulation` of a wire, and of the mesh of its solid. */
extern const struct wb_keys wb_simulated_wire_keys, wb_simulated_wire_mesh_keys;

/* How a wire model was computed. */
struct wb_simulated_wire {
    const char *solver; /* "wire3d" or "wire1d" */
    const struct wb_wire_model *model;
    const struct wb_wire_run *run;
    const struct wb_wire3d_balance *balance; /* NULL: not known (wire1d) */
    double wall, cpu;                        /* s */
    double peak_memory;                      /* bytes; 0: not known */
};

/* Fills an initialised dataset with a computed wire. The bench time grows with the tip's path, by
 * at least 1 ms a row. `simulation` of dataset.json describes the computation and the materials;
 * its `steps` name the last row of each step of the model. */
void wb_simulated_fill_wire(struct wb_dataset *dataset, const struct wb_simulated_wire *wire);

#endif
