/* A harness: branches of wire that meet in a tree, held at some of their nodes, under their weight.
 * Mesh, strains, plastic history, and the assembly and elimination of fe/rod/rod_element.h's
 * elements. The counterpart of fe/rod/rod.h for a tree and for holds at any node.
 *
 * Each branch is a chain of elements from the end of its parent branch, or from the root. Where it
 * leaves, its section is turned against that of its parent by a fixed rotation. Nodes between
 * elements are joints: joint 0 is the root, joint e + 1 the far end of element e.
 *
 * A held joint has prescribed increments in place of rows of equilibrium: its reactions are what
 * its forces lack, and they are exact at equilibrium. So are those of clips through which the wire
 * slides, unknowns beside the motions (fe/harness/harness_slide.h), and those of obstacles
 * (fe/harness/harness_contact.h). The linear system is eliminated
 * from the ends of the branches to the root in blocks of 6 x 6, in a time proportional to the
 * number of joints; the sliding clips border it.
 *
 * The state has a trial and a committed part. After an evaluation, a Newton iteration calls solve
 * and advance. After convergence the trial state is committed; otherwise it is reverted. Nothing is
 * allocated after creation.
 */
#ifndef WB_FE_HARNESS_HARNESS_H
#define WB_FE_HARNESS_HARNESS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "fe/harness/obstacle.h"
#include "fe/rod/law_section.h"
#include "fe/rod/rod_element.h"

struct wb_harness_branch {
    int parent;        /* index of the branch from whose end it leaves, before it; -1: the root */
    double leaving[4]; /* rotation at the start, relative to the parent's end: unit quaternion */
    const struct wb_law_section *section; /* borrowed; must outlive the harness */
    double length;                        /* m */
    double mass;                          /* kg/m */
    double radius;                        /* of its surface, which touches obstacles, m */
    /* Stress-free curvature (twist, ky, kz), 1/m; NULL: straight. Called only during creation. */
    void (*natural_curvature)(void *context, double arc_length, double curvature[3]);
    void *curvature_context;
    int n_stations;
    const double *stations; /* (n_stations) arc lengths at which joints must lie, m, ascending,
                               above 0 and below `length` */
};

/* A rigid body at the end of a branch. */
struct wb_harness_body {
    int branch;
    double mass;      /* kg */
    double centre[3]; /* centre of mass in the frame of the end's section, m */
};

struct wb_harness_model {
    int n_branches;
    const struct wb_harness_branch *branches;
    int n_bodies;
    const struct wb_harness_body *bodies;
    int n_obstacles;
    const struct wb_obstacle *obstacles;
    int most_sliding;        /* joints that slide at a time, at most WB_HARNESS_MOST_SLIDING */
    double gravity[3];       /* m/s2 */
    double element_length;   /* m, at most; 0: 1/100 of the length of all branches */
    struct wb_rod_node root; /* where the root is, with its rotation */
};

/* What of a joint is held. */
enum wb_harness_hold {
    WB_HARNESS_FREE,
    WB_HARNESS_PLANE, /* its position along the first axis of the target's rotation */
    WB_HARNESS_POINT, /* its position */
    WB_HARNESS_AXIS,  /* its position and the direction of its axis */
    WB_HARNESS_FIXED, /* its position and its rotation */
    WB_HARNESS_SLIDE  /* the position of the wire that slides along there, wb_harness_let_slide() */
};

/* Result of an evaluation. Moments are divided by the length of an element to compare with forces.
 */
struct wb_harness_balance {
    double largest_force;    /* largest internal force of any element at any node, N */
    double largest_residual; /* largest unbalanced force of what is not held, N */
    int worst_joint;         /* where that is, or the end of its element */
    double farthest_hold;    /* largest distance of a held joint from its target, m */
    double farthest_turn;    /* and the largest rotation, rad */
    double farthest_contact; /* largest distance of a place that touches from its obstacle, m */
    double largest_contact;  /* largest force of such a place, N */
};

enum {
    WB_HARNESS_MOST_SLIDING = 64
};

struct wb_harness; /* opaque */

/* Allocates all memory; the state is the virgin stress-free shape, with the root held. Keeps
 * nothing of the model but the sections. WB_ERR_ARGUMENT for an invalid model. */
WB_MUST_CHECK enum wb_status wb_harness_create(struct wb_harness **out,
                                               const struct wb_harness_model *model);
void wb_harness_destroy(struct wb_harness *harness); /* accepts NULL */

int wb_harness_n_joints(const struct wb_harness *harness);
/* The joint at a branch's arc length: one of its stations, 0 or its length. */
int wb_harness_joint(const struct wb_harness *harness, int branch, double arc_length);
/* Branch of a joint and its arc length there; the root has branch -1. */
int wb_harness_place_of(const struct wb_harness *harness, int joint, double *arc_length);

/* Holds a joint at a target, or lets it go. */
void wb_harness_set_hold(struct wb_harness *harness, int joint, enum wb_harness_hold hold,
                         const struct wb_rod_node *target);
/* The rotation vector, in space, that brings a joint's rotation `from` to what its hold needs of
 * `to`: all of it, or the shortest that turns its axis there. */
void wb_harness_turn_to(const struct wb_harness *harness, int joint, const struct wb_rod_node *from,
                        const struct wb_rod_node *to, double vector[3]);
enum wb_harness_hold wb_harness_hold(const struct wb_harness *harness, int joint);

/* From now on the wire slides through a clip that is at this joint, and may be anywhere on its
 * branch later; wb_harness_set_hold() with WB_HARNESS_SLIDE moves the clip. `friction` is a
 * coefficient. The wire can turn in the clip. At an end of the branch it is stopped. */
void wb_harness_let_slide(struct wb_harness *harness, int joint, double friction);
/* Length of the branch that moved through the clip since then, towards its beginning, m. */
double wb_harness_slid(const struct wb_harness *harness, int joint);
/* The place of the wire that the hold of a joint holds: the joint, or what is in a sliding clip. */
struct wb_rod_node wb_harness_held_node(const struct wb_harness *harness, int joint);

/* Dead force and moment on a joint, in space, N, N m; 0 after creation. */
void wb_harness_set_load(struct wb_harness *harness, int joint, const double load[6]);
void wb_harness_load(const struct wb_harness *harness, int joint, double load[6]);

/* Viscous drag, N per m of motion and m of wire: `drag` times the motion since the last commit,
 * less `carried` times that of the step before it. 0 after creation. */
void wb_harness_set_drag(struct wb_harness *harness, double drag, double carried);

/* Computes forces and unbalanced forces of the trial state under `weight` times the weight. */
void wb_harness_evaluate(struct wb_harness *harness, double weight,
                         struct wb_harness_balance *balance);

/* Lets wires move on, or stops them, that are at an end of their branch in a sliding clip, as the
 * trial state last evaluated asks for. Returns how many clips it changed; above 0 the state must be
 * evaluated again. */
int wb_harness_adapt(struct wb_harness *harness);

/* Takes the forces of the places that touch an obstacle, of the trial state last evaluated, as
 * known: fe/harness/harness_contact.h. The state must be evaluated again. */
void wb_harness_adapt_contacts(struct wb_harness *harness);
/* Makes obstacles softer than they are at first, before an increment that begins far from its
 * equilibrium. False if there are none. */
bool wb_harness_soften_contacts(struct wb_harness *harness);
/* True if a wire was inside of an obstacle on its straight way since the last commit. */
bool wb_harness_passes_through(const struct wb_harness *harness);

/* Computes Newton's increment of the trial state last evaluated. */
void wb_harness_solve(struct wb_harness *harness);

/* Number of negative eigenvalues of the last solution's stiffness of all that is not held; 0: the
 * equilibrium is stable. With friction, which makes the stiffness unsymmetric, 1 where that number
 * is odd: where a path loses its stability. */
int wb_harness_negative(const struct wb_harness *harness);

/* Moves the trial state by the increment, and evaluates it under the weight of the last evaluation.
 * If a joint would rotate by more than `most_rotation` (rad), the whole increment is scaled down;
 * returns the scale. */
double wb_harness_advance(struct wb_harness *harness, double most_rotation,
                          struct wb_harness_balance *balance);

/* Sets the trial state to the committed state, or extrapolates it along the line through the last
 * two committed states, `ratio` times their distance beyond the last. */
void wb_harness_revert(struct wb_harness *harness);
void wb_harness_extrapolate(struct wb_harness *harness, double ratio);

/* Commits the trial state, which must have been evaluated since it last moved. */
void wb_harness_commit(struct wb_harness *harness);

/* Copies the whole state, with holds, loads, history and plastic work, to memory of the caller, of
 * wb_harness_state_size() bytes, and back: all that follows is then the same, bit for bit. The
 * memory is for this harness, or one of the same model. */
size_t wb_harness_state_size(const struct wb_harness *harness);
void wb_harness_save(const struct wb_harness *harness, void *state);
void wb_harness_restore(struct wb_harness *harness, const void *state);

/* Largest rotation of a joint of the trial state since the last commit, rad. */
double wb_harness_turn(const struct wb_harness *harness);

/* Trial state: a joint (with the rotation of the section that ends there), and the place at a
 * branch's arc length (clamped to its length). */
const struct wb_rod_node *wb_harness_node(const struct wb_harness *harness, int joint);
struct wb_rod_node wb_harness_position(const struct wb_harness *harness, int branch,
                                       double arc_length);

/* A Gauss point in the trial state last evaluated. */
struct wb_harness_point {
    int branch;
    double arc_length;       /* m */
    double length;           /* of wire that it stands for, m */
    double curvature[3];     /* twist, ky, kz, with those of the stress-free shape, 1/m */
    double bending[3];       /* the same, relative to the stress-free shape */
    double force, moment[3]; /* axial, N; in the axes of the section, N m */
};

int wb_harness_n_points(const struct wb_harness *harness);
void wb_harness_point(const struct wb_harness *harness, int index, struct wb_harness_point *point);

/* Elastic energy of the trial state last evaluated, J: what the sections would give back if they
 * were unloaded elastically. */
double wb_harness_elastic_energy(const struct wb_harness *harness);

/* Plastic work since the beginning, J, up to the committed state: dissipated, or kept by the
 * hardening. With the elastic energy it is the work that was done on the sections. */
double wb_harness_plastic_work(const struct wb_harness *harness);

/* Force and moment of a hold on the wire at the last evaluation, in space, N, N m. */
void wb_harness_reaction(const struct wb_harness *harness, int joint, double reaction[6]);

/* Force of an obstacle on the wires at the last evaluation, N, and its moment about the origin. */
void wb_harness_obstacle_force(const struct wb_harness *harness, int obstacle, double force[6]);

/* How deep the trial state is in an obstacle at most, m, but not beside a held joint; and where:
 * not set if 0. */
double wb_harness_depth(const struct wb_harness *harness, int *obstacle, int *branch,
                        double *arc_length);

/* Weight of all branches and bodies, N, and its moment about the origin, of the trial state. */
void wb_harness_weight(const struct wb_harness *harness, double weight[6]);

/* Length of all branches, m. */
double wb_harness_length(const struct wb_harness *harness);

/* Scales of the drag: the largest EI / h^4 of an element of length h, and the smallest EI / L^4 of
 * a branch over the length of all branches; N per m of motion and m of wire. */
void wb_harness_stiffness(const struct wb_harness *harness, double *stiffest, double *softest);

/* Residuals below this force are round-off, N. */
double wb_harness_noise(const struct wb_harness *harness);

#endif
