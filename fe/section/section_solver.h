/* Equilibria of a taped bundle in the section model (fe/section/section_beam.h) along a path of
 * deflections of its tip.
 *
 * Each is found by Newton's method in all unknowns and the tip force, to settings.tolerance of the
 * forces; the friction limits follow from the same state. If a step does not reduce the residual, a
 * line search follows. A move that does not converge is divided; if that does not help, the end
 * reports it and the state stays at the last equilibrium. The first move also applies the weight,
 * in small parts if it bends the bundle much.
 */
#ifndef WB_FE_SECTION_SECTION_SOLVER_H
#define WB_FE_SECTION_SECTION_SOLVER_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/section/section_beam.h"

struct wb_section_solver_settings {
    struct wb_section_beam_settings beam;
    double friction;      /* mu between wires */
    double tolerance;     /* largest residual over the largest force; 0: 1e-6 */
    int most_iterations;  /* of an increment; 0: 40 */
    double smallest_step; /* smallest increment as a fraction of a move; 0: 1/256 */
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
    double tension, vertical; /* N: of the strand or the vertical force; vertical component */
    bool slack;               /* the strand carries no force, the tip is free */
    double residual;          /* over the largest force */
    double missing;           /* imbalance of the transverse loads, over the loads on the wires */
    double tape_plastic;      /* largest accumulated plastic strain of the tape */
    double fold;              /* largest curvature times half the depth of the wires */
    int iterations;           /* of all increments since the last point */
    int increments;
};

struct wb_section_solver; /* opaque */

/* Allocates all memory; the bundle has no loads. `model` is borrowed. Fails for bundles that
 * wb_section_layout_check() rejects. */
WB_MUST_CHECK enum wb_status
wb_section_solver_create(struct wb_section_solver **out, const struct wb_bundle_model *model,
                         const struct wb_section_solver_settings *settings);
void wb_section_solver_destroy(struct wb_section_solver *solver); /* accepts NULL */

/* Moves the tip from its current position to a deflection (m). Not converging is a result, not an
 * error. */
void wb_section_solver_move(struct wb_section_solver *solver, double deflection,
                            struct wb_section_solver_point *point);

/* The beam in its current state; borrowed. */
const struct wb_section_beam *wb_section_solver_beam(const struct wb_section_solver *solver);

#endif
