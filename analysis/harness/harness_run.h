/* Computes a harness file: the steps of the assembly one after another, with shapes, forces, radii
 * and work after each. Called by `wirebench solve harness`. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_RUN_H
#define WB_ANALYSIS_HARNESS_HARNESS_RUN_H

#include <stdbool.h>

#include "analysis/harness/harness_file.h"
#include "base/memory.h"
#include "base/status.h"
#include "fe/harness/harness_solver.h"

struct wb_harness_settings {
    bool is_elastic; /* the same wires without yielding */
    double torsion;  /* factor on a torsional stiffness that the file does not give */
    int frames;      /* shapes of each step, its end included; 0: its end alone */
    /* Of the computation; 0: the defaults. */
    double element_length;               /* m */
    double most_rotation;                /* of a joint in an increment, rad */
    struct wb_rod_section_layout fibres; /* of a section */
};

/* What holds the wires at one item, in its own frame: x along the wire there, z up; or an obstacle,
 * in the obstacle's frame, its moment about its place. */
struct wb_harness_force {
    bool is_mounted;                    /* or touches */
    double force[3], moment[3];         /* on the wire, N, N m */
    double size, moment_size;           /* of both vectors */
    double slid;                        /* m of wire since the mount, towards the beginning of the
                                           branch; NAN: it does not slide there */
    double largest, largest_moment;     /* of them on the way of the step */
    double soft_force;                  /* `size` with a fifth of the default torsional stiffness;
                                           NAN: not computed */
    bool exceeds_force, exceeds_moment; /* a limit, on the way */
};

struct wb_harness_branch_result {
    double least_radius, at;       /* m; where */
    double tightest_radius;        /* m, on the way of the step */
    double largest_bending;        /* curvature relative to the natural shape, 1/m */
    double largest_bending_so_far; /* from the first step on */
    bool is_beyond;                /* the calibrated range */
    bool exceeds_radius;           /* the limit, on the way */
};

/* A place of the shape. */
struct wb_harness_place {
    int branch;
    double s;                /* m, along the branch */
    double position[3];      /* m */
    double direction[3];     /* of the wire */
    double up[3];            /* z axis of its section */
    double curvature, twist; /* 1/m */
    double moment, torque;   /* N m */
    double tension;          /* N */
};

struct wb_harness_step_result {
    enum wb_harness_end end;
    const char *problem;
    double fraction;  /* that was completed */
    int worst_branch; /* of a step that did not converge; -1: none */
    int increments, iterations;
    int n_snaps;
    struct wb_harness_snap snaps[WB_HARNESS_MOST_SNAPS];
    int snap_branch[WB_HARNESS_MOST_SNAPS];    /* -1: the root */
    double snap_at[WB_HARNESS_MOST_SNAPS];     /* m */
    struct wb_harness_force *forces;           /* (n_items, then n_obstacles) */
    struct wb_harness_branch_result *branches; /* (n_branches) */
    struct wb_harness_place *places;           /* (n_places) */
    double elastic;                            /* J: what the wires would give back */
    double plastic;                            /* J: plastic work from the first step on */
};

/* The shape after a step, or a frame within it. */
struct wb_harness_shape {
    double time; /* steps completed, with the fraction of the step, to 1e-6 */
    int step;    /* index; -1: before the first step, free of stress */
    const struct wb_harness_place *places; /* (n_places) */
    const struct wb_harness_force *forces; /* (n_items) of a frame, `largest` up to there */
};

struct wb_harness_result_set {
    const struct wb_harness_plan *plan; /* borrowed */
    struct wb_harness_settings settings;
    int n_elements, n_places;
    double weight; /* N */
    int n_steps;   /* computed, the last one may be incomplete */
    bool converged;
    struct wb_harness_place *natural;       /* (n_places) the stress-free shape */
    struct wb_harness_step_result *results; /* (n_steps of the plan) */
    int n_shapes;
    struct wb_harness_shape *shapes; /* (n_shapes) the natural one, frames and ends in order */
    struct wb_memory *memory;
};

/* A harness whose steps are computed one after another, at first in its stress-free shape. */
struct wb_harness_run; /* opaque */

/* The plan is borrowed. On failure *out is unchanged. */
WB_MUST_CHECK enum wb_status wb_harness_run_create(struct wb_harness_run **out,
                                                   const struct wb_harness_plan *plan,
                                                   const struct wb_harness_settings *settings);
void wb_harness_run_destroy(struct wb_harness_run *run); /* accepts NULL */

/* Takes the arrays of a result; the length of `places`. */
void wb_harness_run_take_memory(const struct wb_harness_run *run, struct wb_memory *memory,
                                struct wb_harness_step_result *result);
int wb_harness_run_n_places(const struct wb_harness_run *run);

/* Computes a step, which must be possible (wb_harness_file_check_step()), into a result with its
 * arrays. Without an equilibrium the state is that of the last one: on the way of a move, before a
 * release. `watch` may be NULL; it returns false to stop. */
void wb_harness_run_step(struct wb_harness_run *run, const struct wb_harness_step *step,
                         bool (*watch)(void *context, double fraction), void *context,
                         struct wb_harness_step_result *result);
/* The result before the first step. */
void wb_harness_run_begin(struct wb_harness_run *run, struct wb_harness_step_result *result);

/* Where an item is, with the rotation of the section there. */
struct wb_rod_node wb_harness_run_item(const struct wb_harness_run *run, int item);

/* Copies the whole state to memory of wb_harness_run_state_size() bytes and back, bit for bit. */
size_t wb_harness_run_state_size(const struct wb_harness_run *run);
void wb_harness_run_save(const struct wb_harness_run *run, void *state);
void wb_harness_run_restore(struct wb_harness_run *run, const void *state);

/* Computes all steps, or up to one that finds no equilibrium, which is a result. `progress` may be
 * NULL; it returns false to stop. */
WB_MUST_CHECK enum wb_status
wb_harness_run_compute(struct wb_harness_result_set *set, const struct wb_harness_plan *plan,
                       const struct wb_harness_settings *settings,
                       bool (*progress)(void *context, int step, double fraction), void *context);
void wb_harness_run_release(struct wb_harness_result_set *set); /* accepts a zeroed one */

/* Where along its branch an item is with the forces of a step or shape (NULL: before the first), m:
 * beyond its place in the file where the wire slid. */
double wb_harness_run_place(const struct wb_harness_plan *plan,
                            const struct wb_harness_force *forces, int item);

/* GJ of a wire as computed, N m2. */
double wb_harness_run_torsion(const struct wb_harness_plan *plan, int wire,
                              const struct wb_harness_settings *settings);

#endif
