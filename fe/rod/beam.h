/* A planar beam: mesh, displacements, plastic history, and the assembly of fe/rod/beam_element.h's
 * elements. Two interfaces: a cantilever, clamped at its first node and loaded at its tip; or all
 * nodes free, for loads and supports along the beam.
 *
 * The state has a trial and a committed part. A Newton iteration calls evaluate, condense, and,
 * with the tip's increment computed by the caller, advance. After convergence the trial state is
 * committed; otherwise it is reverted. Nothing is allocated after creation.
 */
#ifndef WB_FE_ROD_BEAM_H
#define WB_FE_ROD_BEAM_H

#include "base/status.h"
#include "fe/material/material.h"
#include "fe/rod/beam_element.h"
#include "fe/rod/section.h"

struct wb_beam_model {
    const struct wb_section *section; /* borrowed during creation only */
    double length;                    /* m */
    int n_elements;                   /* at least 1 */
    double (*natural_curvature)(void *context, double arc_length); /* 1/m; NULL: straight */
    void *curvature_context;
    double load_x, load_y; /* dead load per reference length, N/m */
};

/* Result of an evaluation. Moments are divided by the beam's length to compare with forces. */
struct wb_beam_balance {
    double largest_force;    /* largest internal force of any element at any node, N */
    double largest_residual; /* largest unbalanced force except at clamp and tip, N */
    double tip[3];           /* internal minus distributed forces at the tip: x, y (N), t (N m) */
};

struct wb_beam; /* opaque */

/* Allocates all memory; the state is the virgin reference configuration. WB_ERR_ARGUMENT for an
 * invalid model. */
WB_MUST_CHECK enum wb_status wb_beam_create(struct wb_beam **out,
                                            const struct wb_beam_model *model);
void wb_beam_destroy(struct wb_beam *beam);

/* Returns to the virgin reference configuration. */
void wb_beam_reset(struct wb_beam *beam);

/* Replaces the section's materials; the array has as many as the section. */
void wb_beam_set_materials(struct wb_beam *beam, const struct wb_material *materials);

/* Replaces the law of a section that was created with one; see wb_fibres_set_law(). */
WB_MUST_CHECK enum wb_status wb_beam_set_law(struct wb_beam *beam, const struct wb_law *law);

/* Duration of the following steps; see wb_fibres_set_duration(). */
void wb_beam_set_duration(struct wb_beam *beam, double duration);

/* Replaces the natural curvature (1/m over arc length; NULL: straight) and resets the beam.
 * WB_ERR_ARGUMENT if the curvature is not finite. */
WB_MUST_CHECK enum wb_status
wb_beam_set_curvature(struct wb_beam *beam,
                      double (*natural_curvature)(void *context, double arc_length), void *context);

/* Computes resultants and unbalanced forces of the trial state under `load_factor` times the
 * distributed load. */
void wb_beam_evaluate(struct wb_beam *beam, double load_factor, struct wb_beam_balance *balance);

/* Condenses the tangent stiffness of the trial state last evaluated to the tip (3 x 3,
 * row-major). */
void wb_beam_condense(struct wb_beam *beam, double *stiffness);

/* Condenses the residual of the trial state last evaluated to the tip, with the last condensed
 * tangent of `tangent`: the beam itself, or a beam with the same number of elements in a similar
 * state. At the tip, stiffness times increment = right (3) minus the forces of the caller's
 * loads. */
void wb_beam_reduce(struct wb_beam *beam, const struct wb_beam *tangent, double *right);

/* Moves the trial state by the increment that belongs to the tip's increment `tip` (3), after
 * wb_beam_reduce() with the same tangent. If a node would rotate by more than `most_rotation`
 * (rad), the whole increment is scaled down; returns the scale. */
double wb_beam_advance(struct wb_beam *beam, const struct wb_beam *tangent, const double *tip,
                       double most_rotation);

/* Predicts the trial state from `leader`, a beam with the same number of elements: this beam moves
 * like the leader from its last committed to its trial state, and the difference between the two
 * beams changes by `ratio` times its last change. */
void wb_beam_follow(struct wb_beam *beam, const struct wb_beam *leader, double ratio);

/* Sets the trial state to the committed state, or extrapolates it along the line through the last
 * two committed states, `ratio` times their distance beyond the last. */
void wb_beam_revert(struct wb_beam *beam);
void wb_beam_extrapolate(struct wb_beam *beam, double ratio);

/* Commits the trial state, which must have been evaluated since it last moved. */
void wb_beam_commit(struct wb_beam *beam);

/* Copies the committed state to a second slot, and back. */
void wb_beam_save(struct wb_beam *beam);
void wb_beam_restore(struct wb_beam *beam);

/* --- all nodes free: for loads and supports along the beam --- */

int wb_beam_count_nodes(const struct wb_beam *beam); /* 2 n_elements + 1 */

double wb_beam_element_length(const struct wb_beam *beam); /* m */

/* The Gauss point nearest to arc length s, in the state last evaluated. */
const struct wb_beam_point *wb_beam_section(const struct wb_beam *beam, double s);

/* Moves the whole beam as a rigid body: places its first node at `first` (position and rotation).
 * Changes all states except the saved one; only allowed directly after a reset. */
void wb_beam_place(struct wb_beam *beam, const struct wb_beam_node *first);

/* Trial positions, (n_nodes). */
const struct wb_beam_node *wb_beam_nodes(const struct wb_beam *beam);

/* Internal minus distributed forces of the trial state last evaluated, (n_nodes): x, y (N), t (N
 * m). */
const double (*wb_beam_residuals(const struct wb_beam *beam))[3];

/* Tangent of element `e` (nodes 2 e, 2 e + 1 and 2 e + 2) in the state last evaluated. */
void wb_beam_element_tangent(const struct wb_beam *beam, int e,
                             struct wb_beam_element_stiffness *stiffness);

/* As wb_beam_advance(), by an increment of each node (n_nodes; x, y, t), including the first. */
double wb_beam_advance_nodes(struct wb_beam *beam, const double (*increment)[3],
                             double most_rotation);

/* Work of the resultants on the strains from the last committed state to the trial state last
 * evaluated, by the trapezoidal rule, J. */
double wb_beam_step_work(const struct wb_beam *beam);

/* Trial position of the tip. */
const struct wb_beam_node *wb_beam_tip(const struct wb_beam *beam);

/* Moment that the clamp exerts, N m, of the state last evaluated; positive bends upwards. */
double wb_beam_root_moment(const struct wb_beam *beam);

/* Residuals below this force are round-off, N. */
double wb_beam_noise(const struct wb_beam *beam);

/* Force scale: bending stiffness of the virgin section divided by the square of the length, N. */
double wb_beam_scale_force(const struct wb_beam *beam);

/* Committed position at reference arc length s (clamped to 0..L). */
struct wb_beam_node wb_beam_position(const struct wb_beam *beam, double s);

#endif
