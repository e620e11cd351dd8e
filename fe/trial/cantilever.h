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

/* Increase whenever results for the same model change: older datasets are then outdated. */
enum {
    WB_CANTILEVER_VERSION = 1
};

/* Meaning of the control value of wb_cantilever_move(). */
enum wb_cantilever_control {
    WB_CONTROL_DEFLECTION,     /* y of the tip, m */
    WB_CONTROL_STAGE,          /* downward travel of the clamp's stage, m; needs a strand */
    WB_CONTROL_DEAD_FORCE,     /* vertical tip force, N; no strand, no unilateral contact */
    WB_CONTROL_FOLLOWER_FORCE, /* tip force normal to the wire, N */
    /* y of the tip, m, prescribed by an unknown follower force; no strand. Under a growing follower
     * force the wire curls up and y has a maximum. This control needs force and deflection to
     * increase together: it stops before the maximum as not converged. */
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
    double counterweight;        /* kg, attached at the tip */
    double mass_per_length;      /* kg/m */
    double gravity_x, gravity_y; /* m/s2; (0, -9.80665) on the bench; (0, 0): no weight */
    double rest_level;           /* m: y of a rest below the tip; only if has_rest */
    bool has_rest;               /* a frictionless rest stops the tip at rest_level from below */
};

struct wb_cantilever_settings {
    double force_tolerance; /* largest residual over the largest internal force; above 0 */
};

enum wb_cantilever_end {
    WB_CANTILEVER_CONVERGED,
    WB_CANTILEVER_NOT_CONVERGED /* the state is the last converged one before the target */
};

/* One equilibrium. */
struct wb_cantilever_point {
    enum wb_cantilever_end end;
    double control;        /* value reached, in the control's unit */
    double deflection;     /* y of the tip, m */
    double tip_x;          /* m */
    double tip_angle;      /* rad */
    double tension;        /* strand tension or vertical tip force, N; not zeroed */
    double vertical_force; /* vertical component of the tension, N */
    double follower;       /* magnitude of the follower force, N, not included in tension and
                              vertical_force; positive pushes the straight wire's tip upwards */
    double root_moment; /* N m, moment at the clamp: the first integration point's, extrapolated by
                           equilibrium */
    bool slack;         /* the strand carries no force */
    bool resting;       /* the tip lies on the rest */
    int iterations;     /* Newton iterations of all sub-steps */
    double residual;    /* last relative residual */
};

struct wb_cantilever; /* opaque: model copy, mesh, state, workspace */

/* All zero except for standard gravity, (0, -9.80665). */
void wb_cantilever_default_model(struct wb_cantilever_model *model);

/* Allocates all memory. `settings` may be NULL: a force tolerance of 1e-12. On failure *out is
 * NULL. */
WB_MUST_CHECK enum wb_status wb_cantilever_create(struct wb_cantilever **out,
                                                  const struct wb_cantilever_model *model,
                                                  const struct wb_cantilever_settings *settings);
void wb_cantilever_destroy(struct wb_cantilever *cantilever);

/* Returns to the virgin, unloaded state (weight not yet applied). Keeps all memory. */
void wb_cantilever_reset(struct wb_cantilever *cantilever);

/* Replaces the section's materials: `materials` has as many entries as the section. Does not change
 * the state; call wb_cantilever_reset() first. */
void wb_cantilever_set_materials(struct wb_cantilever *cantilever,
                                 const struct wb_material *materials);

/* Replaces the law of a section created by wb_section_init_law() by one of the same kind: plain, or
 * an overlay of at most as many parts; otherwise WB_ERR_ARGUMENT. Call wb_cantilever_reset()
 * first. */
WB_MUST_CHECK enum wb_status wb_cantilever_set_law(struct wb_cantilever *cantilever,
                                                   const struct wb_law *law);

/* Duration of each following move (s, 0 to infinity), for a law with Maxwell elements. Infinite
 * after creation: the law is then fully relaxed. */
void wb_cantilever_set_duration(struct wb_cantilever *cantilever, double duration);

/* Replaces the natural curvature and resets; see wb_cantilever_model. */
WB_MUST_CHECK enum wb_status
wb_cantilever_set_curvature(struct wb_cantilever *cantilever,
                            double (*natural_curvature)(void *context, double arc_length),
                            void *context);

/* Moves from the current state to the equilibrium at `target`, in one step or in as many sub-steps
 * as convergence needs. The first move also applies weight and counterweight. Tip loads that are
 * neither the control nor its unknown force stay constant. While the strand is slack, the control
 * describes the position of the strand and the point that of the free tip. Not converging is a
 * result, not an error: point->end reports it, and the state is then that of the last converged
 * sub-step. Errors: an argument that the model does not allow. */
WB_MUST_CHECK enum wb_status wb_cantilever_move(struct wb_cantilever *cantilever,
                                                enum wb_cantilever_control control, double target,
                                                struct wb_cantilever_point *point);

/* Makes the followers move with every following move of the leader. Followers are cantilevers with
 * the same number of elements and the same strand whose parameters differ slightly from the
 * leader's (a fit computes slopes from such differences). A follower's control is the leader's plus
 * its offset. It takes the leader's sub-steps, their duration and the leader's contact mode (taut,
 * resting), and computes its equilibrium by one Newton step with the leader's tangent. Its
 * equilibrium is accurate to second order in the difference from the leader; its plastic strains
 * omit the correction of that one step. Differences are accurate to a few thousandths, at a quarter
 * of the cost of a move of their own. Convergence of followers is not checked. Reset all of them
 * before. Both arrays (n) are borrowed until n is set to 0. */
void wb_cantilever_lead(struct wb_cantilever *leader, int n, struct wb_cantilever *const *followers,
                        const double *offsets);

/* Strand tension or vertical tip force of the last equilibrium, N; also valid for a follower. */
double wb_cantilever_tension(const struct wb_cantilever *cantilever);

/* Saves the state to, or restores it from, a second slot in the cantilever, so that a trial move
 * can be undone. */
void wb_cantilever_save(struct wb_cantilever *cantilever);
void wb_cantilever_restore(struct wb_cantilever *cantilever);

/* Deformed positions at `n` reference arc lengths `s` (m, 0..L), into x and y (each n, m); `angle`
 * (n, rad) may be NULL. */
void wb_cantilever_shape(const struct wb_cantilever *cantilever, int n, const double *s, double *x,
                         double *y, double *angle);

#endif
