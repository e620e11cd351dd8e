/* Equilibria of a taped bundle in the section model (fe/section/section_beam.h), one after the
 * other along a path of deflections of its tip.
 *
 * Each is found by Newton's method in all unknowns and the force that leads the tip, to
 * settings.tolerance of the forces, with the friction that the same state allows: where a step does
 * not bring the residual down, a search along it does. A move that does not converge is divided; if
 * that does not help, the end says so and the state stays at the last equilibrium. The first move
 * brings the weight on, in parts that bend a bundle little.
 */
#ifndef WB_FE_SECTION_SECTION_SOLVER_H
#define WB_FE_SECTION_SECTION_SOLVER_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/section/section_beam.h"

struct wb_section_solver_settings {
    struct wb_section_beam_settings beam;
    double friction;      /* mu between wires */
    double tolerance;     /* residual over the largest force; 0: 1e-6 */
    int most_iterations;  /* of an increment; 0: 40 */
    double smallest_step; /* part of a move below which it gives up; 0: 1/256 */
};

enum wb_section_solver_end {
    WB_SECTION_SOLVER_CONVERGED,
    WB_SECTION_SOLVER_NOT_CONVERGED
};

/* An equilibrium. */
struct wb_section_solver_point {
    enum wb_section_solver_end end;
    double deflection, tip_x; /* m */
    double tip_angle;         /* rad */
    double tension, vertical; /* N: of the strand, or the vertical force; its vertical part */
    bool slack;               /* the strand carries nothing, the tip hangs */
    double residual;          /* over the largest force */
    double missing;           /* of the balance in the plane, over what presses the wires */
    double tape_plastic;      /* largest accumulated plastic strain of the tape */
    double fold;              /* largest curvature times half the depth of the wires */
    int iterations;           /* of all increments since the last point */
    int increments;
};

struct wb_section_solver; /* opaque */

/* Takes all memory; the bundle hangs on nothing. `model` is borrowed. Refuses what
 * fe/section/section_layout.h refuses. */
WB_MUST_CHECK enum wb_status
wb_section_solver_create(struct wb_section_solver **out, const struct wb_bundle_model *model,
                         const struct wb_section_solver_settings *settings);
void wb_section_solver_destroy(struct wb_section_solver *solver); /* accepts NULL */

/* Moves the tip to a deflection (m), from where it is. Not converging is a result. */
void wb_section_solver_move(struct wb_section_solver *solver, double deflection,
                            struct wb_section_solver_point *point);

/* The beam in its present state; borrowed. */
const struct wb_section_beam *wb_section_solver_beam(const struct wb_section_solver *solver);

#endif
