/* The state of a harness, shared by the files of this room: harness.c makes it and remembers it,
 * harness_balance.c evaluates its forces, harness_hold.c its holds, harness_slide.c its sliding
 * clips, harness_newton.c solves for its increment.
 *
 * Nodes are the joints and, after them, the middle nodes of the elements.
 */
#ifndef WB_FE_HARNESS_HARNESS_STATE_H
#define WB_FE_HARNESS_HARNESS_STATE_H

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fe/harness/harness.h"
#include "fe/linear/larger.h"

enum {
    POINTS = WB_ROD_ELEMENT_POINTS,
    NODES = WB_ROD_ELEMENT_NODES,
    U = WB_ROD_ELEMENT_UNKNOWNS,
    WB_HARNESS_CLIP = 4,  /* unknowns of a sliding clip: its place along the wire, its force */
    WB_HARNESS_PLACES = 8 /* of an element that touch an obstacle at a time, at most */
};

/* Elimination of an element's middle node from its end nodes: d2 = w - W1 d1 - W3 d3; and of its
 * far joint from its near joint: d3 = y - X d1. */
struct wb_harness_eliminated {
    double W1[U * U], W3[U * U], X[U * U];
};

/* For further right-hand sides: where loads on the middle node and on the far joint move these, and
 * the stiffnesses between them and the other joints. Of the root, `far` only. */
struct wb_harness_compliance {
    double middle[U * U], far[U * U];
    double near_middle[U * U], far_middle[U * U], near_far[U * U];
};

struct wb_harness_element {
    int branch, near; /* joint at its beginning; its far joint is that of its index plus 1 */
    double begin;     /* arc length, m */
    const struct wb_law_section *section;
    struct wb_rod_shape shape;
    size_t history;           /* where the history of its first point begins */
    size_t row;               /* doubles of a point */
    double weight[3];         /* N/m */
    double radius;            /* of its surface, m */
    double contact_stiffness; /* of a place that touches, N/m */
};

struct wb_harness_chain {
    double leaving[4];
    double length;
    int first, n; /* its elements */
};

struct wb_harness_joint {
    enum wb_harness_hold hold;
    struct wb_rod_node target;
    double load[U];
};

/* An equation beside those of the nodes, for one of the unknowns of a clip: the forces on the nodes
 * of an element for a unit of the unknown, the coefficients of their positions and of the unknowns
 * of the same clip, and the right-hand side. */
struct wb_harness_equation {
    int element;
    double force[NODES][3], row[NODES][3];
    double own[WB_HARNESS_CLIP];
    double right;
};

/* A sliding clip: where along the branch the wire is in it, and its force on the wire. */
struct wb_harness_sliding {
    double s, force[3];
    double slip;    /* motion of s over the presliding distance, from -1 to 1; of a commit */
    bool is_at_end; /* of the branch */
};

struct wb_harness_clip {
    int joint, branch;
    double begin, friction; /* where on the branch it was mounted, m */
    struct wb_harness_sliding now, committed, earlier, origin;
};

/* What is known of a place that touches an obstacle. */
struct wb_harness_touch {
    int element, obstacle;
    bool is_fixed;                /* to the wire; otherwise it is where the gap is smallest */
    double at;                    /* where on the element friction acts, from -1 to 1 */
    double multiplier, normal[3]; /* force along the normal, N, and normal */
    double expected;              /* force after the iteration, N */
    double pressed;               /* force that friction is proportional to, N */
    double missing;               /* force less `pressed` when that was taken before; NAN: not */
    double slip[3];               /* motion along the surface over the presliding distance */
};

struct wb_harness_touches {
    int n;
    struct wb_harness_touch *touch; /* (most_contacts) */
};

/* The same with what was evaluated of it. */
struct wb_harness_contact {
    struct wb_harness_touch touch;              /* `at` is where it was known */
    double at, position[3];                     /* where it is */
    double N[NODES], dN[NODES], rubbing[NODES]; /* shapes at the place, and where friction acts */
    double gap, normal[3], curvature[9];        /* of the surface: gradient of the normal, 1/m */
    double turned[3], bend;                     /* of the gap by the place: see harness_contact.c */
    double force;                               /* along the normal, N */
    double rate;                                /* derivative of the slip by the motion, 1/m */
    bool slips, is_beside;                      /* a joint with a minimum beside it */
};

/* What of a point's section may yield: axial strain and bending. */
struct wb_harness_yielding {
    double force[3], plastic[3];
};

struct wb_harness {
    int n_branches, n_elements, n_joints, n_nodes, n_points;
    int n_bodies, n_clips, most_clips, n_obstacles, n_contacts, most_contacts;
    struct wb_harness_chain *branches;
    struct wb_harness_element *elements;
    struct wb_harness_body *bodies;
    struct wb_harness_joint *joints;
    struct wb_harness_clip *clips;   /* (n_clips of most_clips) that let the wire slide now */
    double *width;                   /* (n_nodes) length of the wire that belongs to a node, m */
    double length;                   /* of all branches, m */
    double gravity[3], lever, noise; /* lever: 1/m, makes moments forces */
    double drag, carried;
    double weight;        /* its factor in the last evaluation */
    double largest_force; /* internal, of the last evaluation */
    size_t history_size;

    /* Strains of the points, (n_points) each: `natural` of the stress-free shape, the others
     * relative to it. `earlier` is the state committed before `committed`. */
    struct wb_rod_strain *natural, *trial, *committed, *earlier;
    struct wb_rod_node root, committed_root, earlier_root;
    struct wb_rod_strain *origin; /* (n_points) of a line search */
    struct wb_rod_node origin_root;
    struct wb_harness_yielding *yielding; /* (n_points) of the committed state */
    double plastic_work;
    double *history, *trial_history;

    struct wb_rod_node *placed;               /* (3 n_elements) nodes of the trial state */
    struct wb_rod_node *committed_nodes;      /* (n_nodes) */
    double (*motion)[U];                      /* (n_nodes) in the last committed step */
    struct wb_rod_point *points;              /* (n_points) */
    double (*residual)[U];                    /* (n_nodes) */
    double (*increment)[U];                   /* (n_nodes) right-hand side, then the solution */
    double (*diagonal)[U * U];                /* (n_joints) */
    struct wb_harness_eliminated *eliminated; /* (n_elements) */
    /* With sliding clips: (n_joints) index e of element e, the last of the root; the
     * equations beside those of the nodes (WB_HARNESS_CLIP of a clip), and their matrices. */
    struct wb_harness_compliance *compliance;
    struct wb_harness_equation *equations;
    double (*vector)[U]; /* (n_nodes) */
    double *system;
    /* With obstacles: the places that touch, in the order of the elements. */
    struct wb_obstacle *obstacles; /* (n_obstacles) */
    struct wb_harness_touches now, committed_touches;
    double contact_factor;               /* on the stiffness of places that touch */
    double last_gap;                     /* largest when it was last chosen, m */
    double relaxation;                   /* of the forces that friction is proportional to */
    struct wb_harness_contact *contacts; /* (n_contacts of most_contacts) of the last evaluation */
    int *first_contact;                  /* (n_elements + 1) */
    bool is_crowded;                     /* more places are near obstacles than most_contacts */
    int negative;
    bool is_odd, rubs;       /* the number of negative eigenvalues is odd; friction acts */
    struct wb_memory memory; /* of all arrays */
};

/* Adds a force at a place, and its moment about the origin, to a sum of both. */
static inline void wb_harness_add_force(double sum[6], const double force[3], const double at[3])
{
    double moment[3];
    wb_vec3_cross(at, force, moment);
    for (int k = 0; k < 3; k++) {
        sum[k] += force[k];
        sum[3 + k] += moment[k];
    }
}

/* How a joint is held: the axes of the bases of its position and of its spin (rows), which of its
 * six components there are held, and their way to the target. */
struct wb_harness_held {
    double axes[2][9];
    bool is[U];
    double way[U];
};

static inline const struct wb_rod_node *wb_harness_joint_node(const struct wb_harness *h, int joint)
{
    return joint == 0 ? &h->root : &h->placed[NODES * (joint - 1) + 2];
}

static inline const struct wb_rod_node *wb_harness_any_node(const struct wb_harness *h, int node)
{
    return node < h->n_joints ? wb_harness_joint_node(h, node)
                              : &h->placed[NODES * (node - h->n_joints) + 1];
}

/* Node n of an element. */
static inline int wb_harness_node_of(const struct wb_harness *h, int element, int n)
{
    return n == 0 ? h->elements[element].near : n == 1 ? h->n_joints + element : element + 1;
}

/* Held by a hold of its own, not by a sliding clip. */
static inline bool wb_harness_is_held(const struct wb_harness *h, int node)
{
    return node < h->n_joints && h->joints[node].hold != WB_HARNESS_FREE &&
           h->joints[node].hold != WB_HARNESS_SLIDE;
}

/* Way through a clip, or along an obstacle, over which friction grows to its limit, m. */
static inline double wb_harness_presliding(const struct wb_harness *h)
{
    return 1e-6 * h->length;
}

static inline double wb_harness_clip_slip(const struct wb_harness *h,
                                          const struct wb_harness_clip *clip)
{
    const double slip =
        clip->committed.slip + (clip->now.s - clip->committed.s) / wb_harness_presliding(h);
    return fmin(fmax(slip, -1.0), 1.0);
}

/* Adds an unbalanced force of a joint to a balance. */
static inline void wb_harness_balance_add(struct wb_harness_balance *balance, double size,
                                          int joint)
{
    if (size > balance->largest_residual || size != size) {
        balance->largest_residual = size;
        balance->worst_joint = joint;
    }
}

/* The drag of a node's part of the wire, over its coefficient; against rotation with half the part
 * as its arm. */
static inline double wb_harness_drag_of(double width, int component)
{
    return component < 3 ? width : 0.25 * width * width * width;
}

/* The element in which a place of a branch lies. */
int wb_harness_element_at(const struct wb_harness *harness, int branch, double arc_length);

/* Places all nodes from the strains of the trial state. */
void wb_harness_place_nodes(struct wb_harness *harness);

void wb_harness_turn_root(struct wb_harness *harness, const double spin[3]);

/* Way and rotation vector between two states of a node. */
void wb_harness_motion(const struct wb_rod_node *was, const struct wb_rod_node *now,
                       double motion[6]);

/* Where the weight of a body acts, relative to its joint, in space; and the weight, N. Returns the
 * joint. */
int wb_harness_body_arm(const struct wb_harness *harness, const struct wb_harness_body *body,
                        double arm[3], double force[3]);

void wb_harness_look_at_hold(const struct wb_harness *harness, int joint,
                             struct wb_harness_held *held);
/* Components of a vector of position and spin, from space to the bases or back. */
void wb_harness_turn_basis(const struct wb_harness_held *held, bool back, double vector[6]);

#endif
