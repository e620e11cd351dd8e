/* The cantilever bending test of the paper's section 3, computed with the 1D beam.
 *
 * Frame: clamp at the origin, x along the straight wire, y upwards; the clamp is horizontal. The
 * tip is raised, either straight to a deflection or by a strand whose upper end stays at x = L
 * (straight above the tip of the straight wire) and moves up as the clamp's stage goes down:
 *
 *     direction of the tension at the tip (sin p, cos p) with sin p = (L - x_tip) / S,
 *     stage travel = y_tip - S (1 - cos p).
 *
 * The strand is weightless and inextensible and only pulls: below zero tension it is slack and the
 * tip is free under weight and counterweight. Models are const while they are solved; states carry
 * displacements and plastic history, so a calibration resets a state and never rebuilds it.
 *
 * Typical use: wb_cantilever_create(), then wb_cantilever_move() through the targets in order.
 */
#ifndef WB_FE_TRIAL_CANTILEVER_H
#define WB_FE_TRIAL_CANTILEVER_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material/law.h"
#include "fe/material/material.h"
#include "fe/rod/section.h"

/* Counted up whenever the same model comes to other numbers: datasets of before are outdated. */
enum {
    WB_CANTILEVER_VERSION = 1
};

/* What the control value of wb_cantilever_move() means. */
enum wb_cantilever_control {
    WB_CONTROL_DEFLECTION,     /* y of the tip, m */
    WB_CONTROL_STAGE,          /* downward travel of the clamp's stage, m; needs a strand */
    WB_CONTROL_DEAD_FORCE,     /* vertical tip force, N; no strand, no unilateral contact */
    WB_CONTROL_FOLLOWER_FORCE, /* tip force that stays normal to the wire, N */
    /* y of the tip, m, by a follower force that is found; no strand. Under a growing follower force
     * the wire curls up and y has a maximum. This control stays where force and deflection grow
     * together: it ends short of the maximum, not converged, and is not for beyond. */
    WB_CONTROL_FOLLOWER_DEFLECTION,
    WB_CONTROL_TIP_MOMENT /* N m */
};

struct wb_cantilever_model {
    const struct wb_section *section; /* borrowed; must outlive the cantilever */
    double length;                    /* m */
    int n_elements;                   /* quadratic elements; 0 means 50 */
    /* Natural (stress-free) curvature theta0'(s), 1/m, positive bends the tip upwards, as a
     * function of arc length; NULL is straight. Called at creation only. */
    double (*natural_curvature)(void *context, double arc_length);
    void *curvature_context;
    double strand_length;        /* m; 0: the tip force is vertical and may push (no slack) */
    double counterweight;        /* kg, hung at the tip */
    double mass_per_length;      /* kg/m */
    double gravity_x, gravity_y; /* m/s2; (0, -9.80665) is the bench; (0, 0) ignores weight */
    double rest_level;           /* m: y of a rest below the tip, see has_rest */
    bool has_rest; /* the tip, when it comes down, rests at rest_level (no friction) */
};

struct wb_cantilever_settings {
    double force_tolerance; /* residual of forces over the largest internal force, 1; 0: 1e-12 */
    int max_iterations;     /* per step; 0: 25 */
    double smallest_step;   /* fraction of the requested move below which it gives up; 0: 1e-4 */
};

enum wb_cantilever_end {
    WB_CANTILEVER_CONVERGED,
    WB_CANTILEVER_NOT_CONVERGED /* the state is at the last converged point short of the target */
};

/* One equilibrium. */
struct wb_cantilever_point {
    enum wb_cantilever_end end;
    double control;        /* the value reached, in the unit of the control */
    double deflection;     /* y of the tip, m */
    double tip_x;          /* m */
    double tip_angle;      /* rad */
    double tension;        /* strand tension or vertical tip force, N; never zeroed */
    double vertical_force; /* vertical part of the tension, N */
    double follower;       /* size of the follower force, N, in neither of the two above; positive
                              pushes the straight wire's tip upwards */
    double root_moment;    /* N m, internal moment at the clamp's first integration point,
                              extrapolated to the clamp by equilibrium */
    bool slack;            /* the strand carries nothing */
    bool resting;          /* the tip lies on the rest */
    int iterations;        /* Newton iterations spent, all sub-steps together */
    double residual;       /* last relative residual */
};

struct wb_cantilever; /* opaque: model copy, mesh, state, workspace */

/* All zero (to be filled in) but for the bench's gravity, (0, -9.80665). */
void wb_cantilever_default_model(struct wb_cantilever_model *model);

/* Takes all memory. `settings` may be NULL. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_cantilever_create(struct wb_cantilever **out,
                                                  const struct wb_cantilever_model *model,
                                                  const struct wb_cantilever_settings *settings);
void wb_cantilever_destroy(struct wb_cantilever *cantilever);

/* Back to the virgin, unloaded state (weight not yet applied). Keeps all memory. */
void wb_cantilever_reset(struct wb_cantilever *cantilever);

/* Exchanges the section's materials: `materials` has as many entries as the section. Implies
 * nothing about the state: reset first. */
void wb_cantilever_set_materials(struct wb_cantilever *cantilever,
                                 const struct wb_material *materials);

/* Exchanges the law of a section made by wb_section_init_law(), for one of the same kind: plain, or
 * an overlay of at most as many parts. WB_ERR_ARGUMENT otherwise. Reset first. */
WB_MUST_CHECK enum wb_status wb_cantilever_set_law(struct wb_cantilever *cantilever,
                                                   const struct wb_law *law);

/* Duration (s, 0 to infinite) of each move that follows, for a law with Maxwell elements; infinite
 * after creation: the moves are then of the relaxed law. */
void wb_cantilever_set_duration(struct wb_cantilever *cantilever, double duration);

/* Exchanges the natural curvature and resets; see wb_cantilever_model. */
WB_MUST_CHECK enum wb_status
wb_cantilever_set_curvature(struct wb_cantilever *cantilever,
                            double (*natural_curvature)(void *context, double arc_length),
                            void *context);

/* Moves to the equilibrium at `target`, from wherever the state is, in one step or in as many
 * sub-steps as convergence needs. The first move also applies weight and counterweight. Tip loads
 * that the control does not name or find stay as they are. While the
 * strand is slack the control is where the strand would be; the point then describes the free tip.
 * WB_OK also when it did not converge: point->end says so, and the state then stays at the last
 * converged sub-step. Errors: an argument that the model does not allow. */
WB_MUST_CHECK enum wb_status wb_cantilever_move(struct wb_cantilever *cantilever,
                                                enum wb_cantilever_control control, double target,
                                                struct wb_cantilever_point *point);

/* Lets others go along with every move of the leader that follows: cantilevers of as many elements
 * and the same strand, of nearly the same numbers (the slopes of a fit are differences of such). A
 * follower's control is the leader's plus its offset; it takes the leader's steps, their duration,
 * and whether the strand is taut or the tip rests, and finds its equilibrium by one step with the
 * leader's tangent. In equilibrium it is to second order in what it differs by from the leader; its
 * plastic strains lag by the correction of one step: differences are right to some thousandths, at
 * a quarter of the cost of a move of its own. That it converges is not checked. Reset all before.
 * Both arrays (n) are borrowed until n is set to 0. */
void wb_cantilever_lead(struct wb_cantilever *leader, int n, struct wb_cantilever *const *followers,
                        const double *offsets);

/* Strand tension or vertical tip force of the last equilibrium, N: that of a follower. */
double wb_cantilever_tension(const struct wb_cantilever *cantilever);

/* Saves the state into, or restores it from, the cantilever's own second slot; together they allow
 * a trial move to be taken back. */
void wb_cantilever_save(struct wb_cantilever *cantilever);
void wb_cantilever_restore(struct wb_cantilever *cantilever);

/* Deformed positions at `n` reference arc lengths `s` (m, 0..L), into x and y (each n, m);
 * `angle` (n, rad) may be NULL. */
void wb_cantilever_shape(const struct wb_cantilever *cantilever, int n, const double *s, double *x,
                         double *y, double *angle);

#endif
