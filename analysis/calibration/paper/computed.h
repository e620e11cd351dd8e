/* Model of a measured bending test: the 1D beam with the test's own natural shape under its own
 * loading (strand or follower force, counterweight, weight), and the same zero of force.
 *
 * The force is the vertical component of the strand's tension less its value at zero deflection on
 * the first loading: each run starts from the virgin wire, moves the tip to zero deflection, sets
 * that force to zero, and continues upwards. In a follower test the force is the magnitude of the
 * follower force, and a run starts from the wire under its weight alone. All memory is allocated at
 * creation; a run resets the state.
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
    struct wb_reason *why; /* receives why a run failed; NULL (default): it is logged */
    /* Law of all runs, which are given its material; borrowed. NULL: each run uses the law of its
     * material. */
    const struct wb_law *law;
    double speed; /* m/s, rate of deflection for the law's Maxwell elements; 0: relaxed law, as
                     always in a follower test */
};

/* Creates the model of one test; `material` gives the shear stiffness (E and nu) and may change
 * with each run. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_computed_create(struct wb_computed **out,
                                                const struct wb_test_info *info,
                                                const struct wb_material *material,
                                                const struct wb_computed_settings *settings);
/* Where it writes why a run failed; NULL: it is logged. */
struct wb_reason *wb_computed_reason(const struct wb_computed *computed);
void wb_computed_destroy(struct wb_computed *computed); /* accepts NULL */

/* Starts a run with a material: virgin wire, tip moved to zero deflection, force set to zero; in a
 * follower test the wire without a force. *reached is false if that did not converge, which ends
 * the run. */
WB_MUST_CHECK enum wb_status wb_computed_start(struct wb_computed *computed,
                                               const struct wb_material *material, bool *reached);

/* Moves the tip to a deflection (m); *force (N, zeroed, or the follower's) is set if it was
 * reached. A follower force does not reach beyond the deflection's maximum. */
WB_MUST_CHECK enum wb_status wb_computed_move(struct wb_computed *computed, double deflection,
                                              double *force, bool *reached);

/* Sets the follower force (N), through the deflection's maximum and beyond; *deflection (m) is set
 * if the force was reached. WB_ERR_ARGUMENT for a test of another kind. */
WB_MUST_CHECK enum wb_status wb_computed_push(struct wb_computed *computed, double force,
                                              double *deflection, bool *reached);

/* Positions at n arc lengths (m) at the current deflection; angle (rad) may be NULL. */
void wb_computed_shape(const struct wb_computed *computed, int n, const double *s, double *x,
                       double *y, double *angle);

/* A whole run over deflections 0, step, ... (n of them): forces (n, N); for a follower test over
 * forces 0, step, ...: deflections (n, m). Values from *n_reached on are NaN. */
WB_MUST_CHECK enum wb_status wb_computed_curve(struct wb_computed *computed,
                                               const struct wb_material *material, int n,
                                               double step, double *values, int *n_reached);

#endif
