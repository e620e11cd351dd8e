/* A rod in space, clamped at its first end: mesh, strains, plastic history, and the assembly of
 * fe/rod/rod_element.h's elements, with an interface at its tip. The counterpart of fe/rod/beam.h
 * for loads that are not planar.
 *
 * The state has a trial and a committed part. A Newton iteration calls evaluate, condense, and,
 * with the tip's increment computed by the caller, advance. After convergence the trial state is
 * committed; otherwise it is reverted. Nothing is allocated after creation.
 *
 * Frame: the clamp is the origin; without natural curvature and with the default rotation of the
 * clamp, the rod lies along x.
 */
#ifndef WB_FE_ROD_ROD_H
#define WB_FE_ROD_ROD_H

#include "base/status.h"
#include "fe/rod/rod_element.h"
#include "fe/rod/rod_section.h"

struct wb_rod_model {
    const struct wb_rod_section *section; /* borrowed; must outlive the rod */
    double length;                        /* m */
    int n_elements;                       /* at least 1 */
    /* Stress-free curvature (twist, ky, kz), 1/m; NULL: straight. Called only during creation. */
    void (*natural_curvature)(void *context, double arc_length, double curvature[3]);
    void *curvature_context;
    double load[3]; /* dead load per reference length, N/m */
};

/* Result of an evaluation. Moments are divided by the rod's length to compare with forces. */
struct wb_rod_balance {
    double largest_force;    /* largest internal force of any element at any node, N */
    double largest_residual; /* largest unbalanced force except at clamp and tip, N */
    double worst_place;      /* its arc length, m */
    double tip[6];           /* internal minus distributed forces at the tip, N, N m */
    double clamp[6];         /* reactions of the clamp on the rod, N, N m */
    int yielding;            /* number of fibres, of all points, that yield in this step */
};

struct wb_rod; /* opaque */

/* Allocates all memory; the state is the virgin reference configuration. WB_ERR_ARGUMENT for an
 * invalid model. */
WB_MUST_CHECK enum wb_status wb_rod_create(struct wb_rod **out, const struct wb_rod_model *model);
void wb_rod_destroy(struct wb_rod *rod); /* accepts NULL */

/* Returns to the virgin reference configuration. */
void wb_rod_reset(struct wb_rod *rod);

/* Computes resultants and unbalanced forces of the trial state under `load_factor` times the
 * distributed load. */
void wb_rod_evaluate(struct wb_rod *rod, double load_factor, struct wb_rod_balance *balance);

/* Condenses the tangent stiffness and the residual of the trial state last evaluated to the tip:
 * stiffness (6 x 6, row-major) times increment (position, spin) = right (6) minus the forces of the
 * caller's loads. */
void wb_rod_condense(struct wb_rod *rod, double *stiffness, double *right);

/* Number of negative eigenvalues that the last condensation eliminated. By Haynsworth's theorem the
 * tangent stiffness has these and those of the condensed matrix. With the tip fixed the rod is
 * stable if the number is 0. */
int wb_rod_negative(const struct wb_rod *rod);

/* Moves the trial state by the increment that belongs to the tip's increment `tip` (6). If a node
 * would rotate by more than `most_rotation` (rad), the whole increment is scaled down; returns the
 * scale. */
double wb_rod_advance(struct wb_rod *rod, const double *tip, double most_rotation);

/* Sets the trial state to the committed state, or extrapolates it along the line through the last
 * two committed states, `ratio` times their distance beyond the last. */
void wb_rod_revert(struct wb_rod *rod);
void wb_rod_extrapolate(struct wb_rod *rod, double ratio);

/* Commits the trial state, which must have been evaluated since it last moved. */
void wb_rod_commit(struct wb_rod *rod);

/* Largest rotation of a node of the trial state since the last commit, rad. */
double wb_rod_turn(const struct wb_rod *rod);

/* Trial state: the tip, and the position at reference arc length s (clamped to 0..L). */
const struct wb_rod_node *wb_rod_tip(const struct wb_rod *rod);
struct wb_rod_node wb_rod_position(const struct wb_rod *rod, double s);

/* Residuals below this force are round-off, N. */
double wb_rod_noise(const struct wb_rod *rod);

/* Force scale: bending stiffness of the virgin section divided by the square of the length, N. */
double wb_rod_scale_force(const struct wb_rod *rod);

/* State of Gauss point `g` (0 .. 2 n_elements - 1, from the clamp) at the last evaluation: arc
 * length, section strains (e, kx, ky, kz) and committed history. */
void wb_rod_point_state(const struct wb_rod *rod, int g, double *s, double *strain,
                        const double **history);

#endif
