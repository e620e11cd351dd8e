/* A beam: mesh, displacements, plastic history, and the assembly of fe/rod/beam_element.h's
 * elements. It is seen either from its free end, with its first end clamped, or by all its nodes,
 * of which none is held.
 *
 * The state has a trial and a committed part. A Newton iteration is evaluate, condense, and, with
 * the tip's increment found by the caller, advance. Converged, the trial is committed; else it is
 * reverted. Nothing is allocated after creation.
 */
#ifndef WB_FE_ROD_BEAM_H
#define WB_FE_ROD_BEAM_H

#include <stdbool.h>

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

/* What an evaluation found. Moments count as forces over the beam's length. */
struct wb_beam_balance {
    double largest_force;    /* largest internal force of any element at any node, N */
    double largest_residual; /* largest unbalanced force, clamp and tip left out, N */
    double tip[3];           /* internal less distributed forces at the tip: x, y (N), t (N m) */
};

struct wb_beam; /* opaque */

/* Takes all memory and stands at the reference, virgin. WB_ERR_ARGUMENT for a model that makes no
 * beam. */
WB_MUST_CHECK enum wb_status wb_beam_create(struct wb_beam **out,
                                            const struct wb_beam_model *model);
void wb_beam_destroy(struct wb_beam *beam);

/* Back to the reference configuration, virgin. */
void wb_beam_reset(struct wb_beam *beam);

/* Exchanges the section's materials, as many as the section has. */
void wb_beam_set_materials(struct wb_beam *beam, const struct wb_material *materials);

/* The same with the law of a section of one law: wb_fibres_set_law(). */
WB_MUST_CHECK enum wb_status wb_beam_set_law(struct wb_beam *beam, const struct wb_law *law);

/* wb_fibres_set_duration(). */
void wb_beam_set_duration(struct wb_beam *beam, double duration);

/* Exchanges the natural curvature (1/m over arc length; NULL: straight) and resets the beam.
 * WB_ERR_ARGUMENT where it is not finite. */
WB_MUST_CHECK enum wb_status
wb_beam_set_curvature(struct wb_beam *beam,
                      double (*natural_curvature)(void *context, double arc_length), void *context);

/* Resultants and unbalanced forces of the trial state under `load_factor` times the distributed
 * load. */
void wb_beam_evaluate(struct wb_beam *beam, double load_factor, struct wb_beam_balance *balance);

/* Tangent stiffness of the trial state last evaluated, condensed to the tip (3 x 3, row-major). */
void wb_beam_condense(struct wb_beam *beam, double *stiffness);

/* What is unbalanced in the trial state last evaluated, condensed to the tip by the tangent last
 * condensed: its own, or that of a beam of as many elements near by. At the tip, stiffness times
 * increment = right (3) less what the caller's loads add. */
void wb_beam_reduce(struct wb_beam *beam, const struct wb_beam *tangent, double *right);

/* Moves the trial state by the increment that belongs to `tip` (3), after wb_beam_reduce() with the
 * same tangent. Where a node would turn by more than `most_rotation` (rad), all of the increment is
 * scaled down; returns the scale. */
double wb_beam_advance(struct wb_beam *beam, const struct wb_beam *tangent, const double *tip,
                       double most_rotation);

/* Trial = where the beam stands if it has moved as another of as many elements, from its last
 * committed state to its trial state, and what they differ by goes on by `ratio` times its last
 * change. */
void wb_beam_follow(struct wb_beam *beam, const struct wb_beam *leader, double ratio);

/* Trial = committed, or the line through the last two committed states at `ratio` times their
 * distance beyond the last. */
void wb_beam_revert(struct wb_beam *beam);
void wb_beam_extrapolate(struct wb_beam *beam, double ratio);

/* Committed = trial, which must have been evaluated since it last moved. */
void wb_beam_commit(struct wb_beam *beam);

/* Copies the committed state into the second slot and back. */
void wb_beam_save(struct wb_beam *beam);
void wb_beam_restore(struct wb_beam *beam);

/* --- all nodes, none of them held: for loads and supports along the beam --- */

int wb_beam_count_nodes(const struct wb_beam *beam); /* 2 n_elements + 1 */

double wb_beam_element_length(const struct wb_beam *beam); /* m */

/* The Gauss point nearest to arc length s, of the state last evaluated. */
const struct wb_beam_point *wb_beam_section(const struct wb_beam *beam, double s);

/* Moves the whole beam without strain: its first node to that position and rotation. All states
 * but the saved ones stand there then; for a beam that was just reset. */
void wb_beam_place(struct wb_beam *beam, const struct wb_beam_node *first);

/* Trial positions, (n_nodes). */
const struct wb_beam_node *wb_beam_nodes(const struct wb_beam *beam);

/* Internal less distributed forces of the trial state last evaluated, (n_nodes): x, y (N), t (N m).
 */
const double (*wb_beam_residuals(const struct wb_beam *beam))[3];

/* Tangent of element `e`, whose nodes are 2 e, 2 e + 1 and 2 e + 2, of that state. */
void wb_beam_element_tangent(const struct wb_beam *beam, int e,
                             struct wb_beam_element_stiffness *stiffness);

/* As wb_beam_advance(), by an increment of every node (n_nodes; x, y, t), the first one's too. */
double wb_beam_advance_nodes(struct wb_beam *beam, const double (*increment)[3],
                             double most_rotation);

/* Work of the resultants on the strains from the last committed state to the trial state last
 * evaluated, by the trapezoidal rule, J. */
double wb_beam_step_work(const struct wb_beam *beam);

/* Trial position of the tip. */
const struct wb_beam_node *wb_beam_tip(const struct wb_beam *beam);

/* Moment that the clamp exerts, N m, of the state last evaluated; positive bends upwards. */
double wb_beam_root_moment(const struct wb_beam *beam);

/* Force below which residuals are round-off, N. */
double wb_beam_noise(const struct wb_beam *beam);

/* Bending stiffness of the virgin section over the square of the length: a force to scale by, N. */
double wb_beam_scale_force(const struct wb_beam *beam);

/* Committed position at reference arc length s (clamped to 0..L). */
struct wb_beam_node wb_beam_position(const struct wb_beam *beam, double s);

#endif
