/* A taped bundle bent as a cantilever, in static equilibrium: an implicit model of fibre beams that
 * cross-checks the explicit one (fe/bundle/bundle.h). It shares no kernel with it.
 *
 * Wires: planar Simo-Reissner beams of two nodes, one Gauss point and the fibres of
 * fe/rod/fibres.h: large rotations in the plane of bending, and elastic lateral bending with a
 * small displacement z. They do not twist and roll on each other freely.
 *
 * Contact: neighbours touch along lines, k times the depth (k = 0.25 E as in
 * fe/swept/swept_contact.h), between places that face each other across the mean section, found
 * again in every increment. Friction acts along the wires only: an elastic spring on their slip,
 * returned to mu times the normal force, with a history along the path. A rate has no meaning here:
 * mu is constant. Open contact pulls back weakly (see open_stiffness).
 *
 * Tape: a membrane of plane stress (J2, power law, logarithmic strain) between lines of nodes on
 * the wires' arcs, one element across each straight piece. A node is tied to its wire's surface by
 * K_nn across and K_ss along and around it, without damage; openings turn with the wire. The tape's
 * wall has no bending stiffness of its own.
 *
 * Symmetry: the section must be its own mirror image in the plane of bending (z -> -z), and only
 * what is symmetric is looked for. Wires keep their diameter.
 *
 * Loading: clamp at x = 0 (and over the potted length); the tip's mean height, over the wires'
 * masses, is led by one vertical force or by a strand that only pulls. See docs/theory.md, "Static
 * cross-check".
 */
#ifndef WB_TESTS_TWIN_BUNDLE_STATIC_H
#define WB_TESTS_TWIN_BUNDLE_STATIC_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/model/bundle_model.h"

enum wb_bundle_static_contact {
    WB_BUNDLE_STATIC_TOUCHING, /* contact and friction */
    WB_BUNDLE_STATIC_APART,    /* wires do not know of each other */
    WB_BUNDLE_STATIC_HELD,     /* wires that face each other do not part, and rub */
    WB_BUNDLE_STATIC_GLUED     /* wires that face each other neither part nor slip */
};

/* All zero is the default. */
struct wb_bundle_static_settings {
    int n_elements; /* along a wire; 0: 80 */
    int arc_nodes;  /* lines of tape nodes on a wire's arc, at least 2; 0: 3 */
    int n_fibres;   /* of a wire's section; 0: 20 */
    bool no_tape;
    enum wb_bundle_static_contact contact;
    bool has_friction; /* `friction` replaces the model's static one */
    double friction;
    double squeeze; /* N/m: further normal force of all contacts, in the limit of friction only, as
                       if forces from outside pressed the wires together */
    double stiffness;          /* of contact, k / E; 0: 0.25 */
    double tangential_ratio;   /* k_t / k; 0: 0.5 */
    double open_stiffness;     /* of contact while it is open, over that of pressure: a weak pull
                                  without which the places of loose wires between others are not
                                  determined; 0: 1e-3 */
    double largest_increment;  /* m of deflection; 0: 1/200 of the length */
    double smallest_increment; /* m; 0: 1/1000 of the largest */
    double force_tolerance;    /* residual over the largest force in a wire; 0: 1e-7 */
    int max_iterations;        /* of an increment; 0: 25 */
};

enum wb_bundle_static_end {
    WB_BUNDLE_STATIC_CONVERGED,
    WB_BUNDLE_STATIC_NOT_CONVERGED /* the state is the last equilibrium short of the target */
};

/* An equilibrium. */
struct wb_bundle_static_point {
    enum wb_bundle_static_end end;
    double deflection; /* m, mean height of the tip */
    double tip_x;      /* m, mean */
    double vertical;   /* N */
    double tension;    /* N, of the strand, or the vertical force */
    bool slack;
    double largest_slip; /* m, of places that face each other, along the wires */
    double slipping;     /* share of the contact's length that is pressed and at its limit */
    double pressed;      /* share of the contact's length that is pressed */
    double normal;       /* N, sum of the normal forces of all contacts, without squeeze */
    double deepest;      /* m, penetration */
    double tape_strain;  /* largest principal logarithmic strain of the tape */
    int increments, iterations, cutbacks; /* of the move */
    double residual;                      /* relative, of the last iteration */
    char problem[200];                    /* why it did not converge; "" otherwise */
};

struct wb_bundle_static; /* opaque */

/* `model` is borrowed and must outlive it; `settings` may be NULL. WB_ERR_UNSUPPORTED for sections
 * without mirror symmetry, capped tips, damage, and tapes that are not sleeves, lie on a circle, or
 * are bonded beside where they lie. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status
wb_bundle_static_create(struct wb_bundle_static **out, const struct wb_bundle_model *model,
                        const struct wb_bundle_static_settings *settings);
void wb_bundle_static_destroy(struct wb_bundle_static *bundle); /* accepts NULL */

/* Leads the tip from where it is to `deflection` (m), through as many equilibria as it needs; the
 * first move also brings on the weight. Not converging is a result (point->end). */
WB_MUST_CHECK enum wb_status wb_bundle_static_move(struct wb_bundle_static *bundle,
                                                   double deflection,
                                                   struct wb_bundle_static_point *point);

int wb_bundle_static_unknowns(const struct wb_bundle_static *bundle);

/* Axis at n arc lengths s (m): mean of the wires' centres over masses, from 0 at the clamp. */
void wb_bundle_static_shape(const struct wb_bundle_static *bundle, int n, const double *s,
                            double (*shape)[2]);

/* A wire in the last equilibrium. */
struct wb_bundle_static_wire {
    double x, y, z, angle; /* m, rad: of its node `station` */
    double stretch, shear,
        curvature; /* of the element before it (station 0: the first), 1, 1, 1/m */
    double normal, transverse, moment; /* the element's resultants, N, N, N m */
};
void wb_bundle_static_get_wire(const struct wb_bundle_static *bundle, int wire, int station,
                               struct wb_bundle_static_wire *out);

/* Work of the tip's force and of the weight since the virgin bundle (trapezoids over increments),
 * and where it is, J: in wires (stored and dissipated), contact (stored), friction (dissipated),
 * tape (stored and dissipated), bonds (stored). */
struct wb_bundle_static_energies {
    double external;
    double wires, contact, friction, tape, bonds;
};
void wb_bundle_static_get_energies(const struct wb_bundle_static *bundle,
                                   struct wb_bundle_static_energies *energies);

#endif
