/* Central differences for a swept body: accelerations, velocities, positions (eqs. 23 to 25 of the
 * paper, with u(t + dt) = u(t) + dt v(t + dt / 2)).
 *
 * Masses are lumped: a node's mass per length times its station's length, half at the ends, times
 * f_m (eq. 29). The weight is not scaled: gravity accelerates by g / f_m. Selective mass scaling by
 * beta keeps the mean acceleration of a station and divides the nodes' deviations from it,
 *
 *     a = mean + (a - mean) / beta,  mean = sum f / sum m,
 *
 * which corresponds to a mass matrix M' = beta M - (beta - 1) M 1 1^T M / (1^T M 1): the section
 * deforms and rotates more slowly, the motion of the wire's axis is unchanged.
 *
 * A fixed component of a station keeps its velocity for any force: to prescribe a motion, the
 * caller fixes the component and writes its velocity into the field. Fixed components are excluded
 * from the sums.
 */
#ifndef WB_FE_SWEPT_SWEPT_STEP_H
#define WB_FE_SWEPT_SWEPT_STEP_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/swept/swept.h"

struct wb_swept_step_model {
    struct wb_swept_layout layout;
    const double *node_mass; /* (n_nodes), kg/m; copied */
    double spacing;          /* of the stations, m */
    double mass_scaling;     /* f_m, 1; 0: 1 */
    double selective;        /* beta, 1 or more; 0: 1 */
    double gravity[3];       /* m/s2 */
    bool double_precision;   /* forces are double */
};

struct wb_swept_step_fields {
    double *position, *velocity;
    const void *force;
};

/* Sums over the body at the time of the forces. */
struct wb_swept_step_sums {
    double kinetic; /* J, 1/2 v-.M v+ of the velocities half a step before and after: its sum with
                       an elastic energy is constant to round-off */
    double kinetic_half; /* J, 1/2 v+.M v+ */
    double momentum[3];  /* kg m/s, of v+ */
    double gravity_work; /* J, work from this time to the end of the step */
};

struct wb_swept_step; /* opaque */

WB_MUST_CHECK enum wb_status wb_swept_step_create(struct wb_swept_step **out,
                                                  const struct wb_swept_step_model *model);
void wb_swept_step_destroy(struct wb_swept_step *step);

/* WB_ERR_ARGUMENT unless the masses of n nodes are positive and selective mass scaling is 1 or
 * more. */
WB_MUST_CHECK enum wb_status wb_swept_step_check_masses(int n, const double *node_mass,
                                                        double selective);

/* Fixes or releases one component of a station. */
void wb_swept_step_hold(struct wb_swept_step *step, int station, int component, bool held);

/* Advances velocities by `times[0]` (mean of the steps before and after; half a step at first) and
 * positions by `times[1]`, s, at the stations of blocks `first` to `end` - 1. `sums` are added to;
 * may be NULL. */
void wb_swept_step_update(const struct wb_swept_step *step,
                          const struct wb_swept_step_fields *fields, const double times[2],
                          int first, int end, struct wb_swept_step_sums *sums);

#endif
