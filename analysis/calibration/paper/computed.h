/* A measured bending test, computed: the 1D beam with the test's own natural shape under its own
 * loading (strand or follower force, counterweight, weight), and the same zero of force.
 *
 * The force is the vertical part of the strand's tension less its value at zero deflection on the
 * first loading: each run starts from the virgin wire, brings the tip to zero deflection, takes
 * that force as zero, and continues upwards. In a follower test the force is the follower's size,
 * and a run starts from the wire under its weight only. All memory is taken at creation; a run
 * resets the state.
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_COMPUTED_H
#define WB_ANALYSIS_CALIBRATION_PAPER_COMPUTED_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"
#include "fe/material/material.h"

struct wb_computed; /* opaque */

struct wb_computed_settings {
    bool straight;         /* ignore the natural shape */
    int n_elements;        /* 0: 50 */
    int n_fibres;          /* 0: 20 */
    struct wb_reason *why; /* why a run failed is written here; NULL (default): logged */
    /* Borrowed while the beam lives; NULL: runs compute with their materials. Otherwise with this
     * law, whose material they are then given. */
    const struct wb_law *law;
    double speed; /* m/s, of the deflection, at which the law's Maxwell elements relax; 0: of the
                     relaxed law, as a follower test always is */
};

/* For one test; `material` gives the shear stiffness (E and nu) and may be exchanged by each run.
 * On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_computed_create(struct wb_computed **out,
                                                const struct wb_test_info *info,
                                                const struct wb_material *material,
                                                const struct wb_computed_settings *settings);
/* Where it writes why a run failed; NULL: it logs that. */
struct wb_reason *wb_computed_reason(const struct wb_computed *computed);
void wb_computed_destroy(struct wb_computed *computed); /* accepts NULL */

/* Starts a run with a material: virgin wire, tip brought to zero deflection, zero taken; in a
 * follower test the wire without a force. *reached is false when that did not converge; the run is
 * then at its end.
 */
WB_MUST_CHECK enum wb_status wb_computed_start(struct wb_computed *computed,
                                               const struct wb_material *material, bool *reached);

/* Moves the tip to a deflection (m); *force (N, zeroed, or the follower's) is written when it was
 * reached. A follower force does not reach beyond the deflection's maximum. */
WB_MUST_CHECK enum wb_status wb_computed_move(struct wb_computed *computed, double deflection,
                                              double *force, bool *reached);

/* Brings the follower force to a size (N), through the deflection's maximum and beyond; *deflection
 * (m) is written when it was reached. WB_ERR_ARGUMENT for a test of another kind. */
WB_MUST_CHECK enum wb_status wb_computed_push(struct wb_computed *computed, double force,
                                              double *deflection, bool *reached);

/* Positions at n arc lengths (m) at the present deflection; angle (rad) may be NULL. */
void wb_computed_shape(const struct wb_computed *computed, int n, const double *s, double *x,
                       double *y, double *angle);

/* A whole run over deflections 0, step, ... (n of them): forces (n, N); of a follower test over
 * forces 0, step, ...: deflections (n, m). NaN from *n_reached on. */
WB_MUST_CHECK enum wb_status wb_computed_curve(struct wb_computed *computed,
                                               const struct wb_material *material, int n,
                                               double step, double *values, int *n_reached);

#endif
