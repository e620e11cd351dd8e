/* The bending test computed: the 1D beam under a measured test's own loading (strand,
 * counterweight, weight, natural shape), its force zeroed as the test's is.
 *
 * The force is the vertical part of the strand's tension less its value at zero deflection on the
 * first loading: each run starts from the virgin wire, brings the tip to zero deflection, takes
 * that force as zero, and goes on upwards. All memory is taken at creation; a run resets the state.
 */
#ifndef WB_ANALYSIS_COMPUTED_H
#define WB_ANALYSIS_COMPUTED_H

#include <stdbool.h>

#include "analysis/dataset.h"
#include "base/status.h"
#include "fe/material.h"

struct wb_computed; /* opaque */

struct wb_computed_settings {
    bool straight;  /* ignore the natural shape */
    int n_elements; /* 0: 50 */
    int n_fibres;   /* 0: 20 */
};

/* For one test; `material` gives the shear stiffness (E and nu) and may be exchanged by each run.
 * On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_computed_create(struct wb_computed **out,
                                                const struct wb_test_info *info,
                                                const struct wb_material *material,
                                                const struct wb_computed_settings *settings);
void wb_computed_destroy(struct wb_computed *computed); /* accepts NULL */

/* Starts a run with a material: virgin wire, tip brought to zero deflection, zero taken. *reached
 * is false when that did not converge; the run is then at its end. */
WB_MUST_CHECK enum wb_status wb_computed_start(struct wb_computed *computed,
                                               const struct wb_material *material, bool *reached);

/* Moves the tip to a deflection (m); *force (N, zeroed) is written when it was reached. */
WB_MUST_CHECK enum wb_status wb_computed_move(struct wb_computed *computed, double deflection,
                                              double *force, bool *reached);

/* Positions at n arc lengths (m) at the present deflection. */
void wb_computed_shape(const struct wb_computed *computed, int n, const double *s, double *x,
                       double *y);

/* A whole run over deflections 0, step, ... (n of them): force (n, N), NaN from *n_reached on. */
WB_MUST_CHECK enum wb_status wb_computed_curve(struct wb_computed *computed,
                                               const struct wb_material *material, int n,
                                               double step, double *force, int *n_reached);

#endif
