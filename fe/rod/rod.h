/* A rod in space, clamped at its first end: mesh, strains, plastic history, and the assembly of
 * fe/rod/rod_element.h's elements, seen from its free end. The counterpart of fe/rod/beam.h, for
 * loads that are not planar.
 *
 * The state has a trial and a committed part. A Newton iteration is evaluate, condense, and, with
 * the tip's increment found by the caller, advance. Converged, the trial is committed; else it is
 * reverted. Nothing is allocated after creation.
 *
 * Frame: the clamp is the origin; without natural curvature and with the clamp as it is by default,
 * the rod lies along x.
 */
#ifndef WB_FE_ROD_ROD_H
#define WB_FE_ROD_ROD_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/rod/rod_element.h"
#include "fe/rod/rod_section.h"

struct wb_rod_model {
    const struct wb_rod_section *section; /* borrowed; must outlive the rod */
    double length;                        /* m */
    int n_elements;                       /* at least 1 */
    /* Stress-free curvature (twist, ky, kz), 1/m; NULL: straight. Called at creation only. */
    void (*natural_curvature)(void *context, double arc_length, double curvature[3]);
    void *curvature_context;
    double load[3];   /* dead load per reference length, N/m */
    bool has_balance; /* keep account of energy, see wb_rod_energy() of fe/rod/rod_private.h */
};

/* What an evaluation found. Moments count as forces over the rod's length. */
struct wb_rod_balance {
    double largest_force;    /* largest internal force of any element at any node, N */
    double largest_residual; /* largest unbalanced force, clamp and tip left out, N */
    double worst_place;      /* its arc length, m */
    double tip[6];           /* internal less distributed forces at the tip, N, N m */
    double clamp[6];         /* what the clamp exerts on the rod, N, N m */
    int yielding;            /* fibres that yield in this step, of all points */
};

struct wb_rod; /* opaque */

/* Takes all memory and stands at the reference, virgin. WB_ERR_ARGUMENT for a model that makes no
 * rod. */
WB_MUST_CHECK enum wb_status wb_rod_create(struct wb_rod **out, const struct wb_rod_model *model);
void wb_rod_destroy(struct wb_rod *rod); /* accepts NULL */

/* Back to the reference configuration, virgin. */
void wb_rod_reset(struct wb_rod *rod);

/* Resultants and unbalanced forces of the trial state under `load_factor` times the distributed
 * load. */
void wb_rod_evaluate(struct wb_rod *rod, double load_factor, struct wb_rod_balance *balance);

/* Tangent stiffness of the trial state last evaluated, condensed to the tip: at the tip,
 * stiffness (6 x 6, row-major) times increment (position, spin) = right (6) less what the caller's
 * loads add. */
void wb_rod_condense(struct wb_rod *rod, double *stiffness, double *right);

/* Eigenvalues below zero that the last condensation eliminated: the tangent stiffness has these and
 * those of the condensed one (Haynsworth). With the tip held the rod is stable where there are
 * none. */
int wb_rod_negative(const struct wb_rod *rod);

/* Moves the trial state by the increment that belongs to `tip` (6). Where a node would turn by more
 * than `most_rotation` (rad), all of the increment is scaled down; returns the scale. */
double wb_rod_advance(struct wb_rod *rod, const double *tip, double most_rotation);

/* Trial = committed, or the line through the last two committed states at `ratio` times their
 * distance beyond the last. */
void wb_rod_revert(struct wb_rod *rod);
void wb_rod_extrapolate(struct wb_rod *rod, double ratio);

/* Committed = trial, which must have been evaluated since it last moved. */
void wb_rod_commit(struct wb_rod *rod);

/* Largest angle by which a node of the trial state has turned since the last commit, rad. */
double wb_rod_turn(const struct wb_rod *rod);

/* Of the trial state: the tip, and what is at reference arc length s (clamped to 0..L). */
const struct wb_rod_node *wb_rod_tip(const struct wb_rod *rod);
struct wb_rod_node wb_rod_position(const struct wb_rod *rod, double s);

/* Force below which residuals are round-off, N. */
double wb_rod_noise(const struct wb_rod *rod);

/* Bending stiffness of the virgin section over the square of the length: a force to scale by, N. */
double wb_rod_scale_force(const struct wb_rod *rod);

/* Of Gauss point `g` (0 .. 2 n_elements - 1), from the clamp, in the state last evaluated: arc
 * length, section strains (e, kx, ky, kz) and committed history. */
void wb_rod_point_state(const struct wb_rod *rod, int g, double *s, double *strain,
                        const double **history);

#endif
