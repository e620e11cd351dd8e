/* Specimens of the virtual rig without clocks: the same wire, instruments, noise and alignment as
 * in a recording of the rig, but computed sequentially at full speed. */
#ifndef WB_TESTS_ANALYSIS_FAST_RIG_H
#define WB_TESTS_ANALYSIS_FAST_RIG_H

#include <stdint.h>

#include "analysis/dataset/dataset.h"
#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "fe/model/wire.h"
#include "fixtures/virtual/composite.h"
#include "fixtures/virtual/truth.h"

/* One specimen's test. */
struct fast_rig {
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_wire wire;
    struct wb_composite composite;
    enum wb_composite_variant variant;
    struct wb_truth truth;
    int cycles;
    double travel;   /* m */
    double dwell;    /* s, at the turn; 0.2 */
    int every_frame; /* of the cameras' is taken; 6: as many frames as the dataset has rows */
    double noise;    /* factor on the noise of the cell and of the markers; 1 */
    /* Deviations of the bench's files, and of the cell, from the true specimen. */
    struct wb_test_uncertainty off;
};

/* The paper's bench, a type (1 to 3), a length (m), a seed; one cycle of 53 mm. */
void fast_rig_init(struct fast_rig *fast, int type, double length, uint64_t seed);

/* The dataset of its test. */
WB_MUST_CHECK enum wb_status fast_rig_run(const struct fast_rig *fast, struct wb_dataset *dataset);

/* The true section of the specimen: bending moment of a first loading (N m) at n ascending
 * curvatures (1/m), reached at the speed of the test; elastic flexural rigidity (N m2); residual
 * curvature after unloading from the last curvature, at that speed. Any may be NULL. */
void fast_rig_truth(const struct fast_rig *fast, int n, const double *curvature, double *moment,
                    double *rigidity, double *residual_curvature);

/* Change of its moment on unloading from the largest curvature, over n ascending changes of
 * curvature, as stiffness, N m2. */
void fast_rig_unloading(const struct fast_rig *fast, double largest, int n, const double *change,
                        double *stiffness);

/* Shifts the zero of deflection of a dataset by `by` (m), as an alignment with this error does: the
 * force is relative to the tension at the shifted zero, from a line through 1 to 3 mm. */
void fast_rig_shift_deflection(struct wb_dataset *dataset, double by);

#endif
