/* Harness files (`kind: harness`): wires, branches in a tree, connectors, clips, and the steps of
 * an assembly.
 *
 *     kind: harness
 *     name: small
 *     title: A trunk with two leads   # optional
 *     gravity_m_s2: [0, 0, -9.80665]  # optional
 *     wires:
 *       - {name: trunk, wire: bundle-7}
 *       - {name: lead, wire: type3, torsional_stiffness_N_mm2: 600}
 *     root: {name: R, at_mm: [0, 0, 0], direction: [1, 0, 0], up: [0, 0, 1]}
 *     branches:
 *       - {name: B1, from: R, to: J, wire: trunk, length_mm: 300}
 *       - {name: B2, from: J, to: K1, wire: lead, length_mm: 200, angle_deg: 40, around_deg: 90}
 *     connectors:
 *       - {name: K1, mass_g: 12, centre_mm: [15, 0, 0]}   # at the end of the branch to K1
 *     clips:
 *       - {name: C1, branch: B1, at_mm: 150, holds: axis}
 *     obstacles:
 *       - {name: sill, shape: box, at_mm: [0, 0, -40], size_mm: [50, 200, 20], friction: 0.3}
 *     steps:
 *       - hang
 *       - {mount: C1, at_mm: [140, 20, 10], direction: [1, 0.1, 0]}
 *       - {move: C1, at_mm: [150, 0, 0]}
 *       - {release: C1}
 *       - take_off
 *
 * A wire is a wire file, a shipped wire, a properties file, or a bundle file, which stands for its
 * calibrated beam (`published`, `beam`). A branch begins with the axis of the
 * branch before it, or of the root, turned by `angle_deg` towards `around_deg`: the direction
 * around that axis, from `up` on. Its natural shape is straight, or has the curvatures about its y
 * and z axes, constant or between places. The frame of a wire's section: x along the wire, z up, y
 * = z x x. An obstacle is rigid: what is behind a plane, whose direction points out of it; a
 * cylinder along its direction; a box whose first size is along its direction and the last up.
 */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_FILE_H
#define WB_ANALYSIS_HARNESS_HARNESS_FILE_H

#include <stdbool.h>

#include "analysis/predict/specimens.h"
#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/status.h"
#include "fe/harness/harness.h"
#include "fe/material/law.h"

enum {
    WB_HARNESS_MOST_WIRES = 32,
    WB_HARNESS_MOST_BRANCHES = 100,
    WB_HARNESS_MOST_ITEMS = 201, /* the root, connectors and clips */
    WB_HARNESS_MOST_OBSTACLES = 20,
    WB_HARNESS_MOST_STEPS = 500,
    WB_HARNESS_MOST_CURVE = 50, /* places of a natural shape */
    WB_HARNESS_NAME = 40
};

struct wb_harness_wire {
    char name[WB_HARNESS_NAME];
    char file[96]; /* name of its file, without folders */
    char sha256[WB_SHA256_TEXT];
    double diameter; /* m */
    double mass;     /* kg/m */
    struct wb_law law;
    double torsional_stiffness;    /* N m2; 0: EI / (1 + nu) */
    double largest_curvature;      /* 1/m, of the calibration; NAN: not known */
    bool has_unloading;            /* calibrated on unloading, too */
    bool is_virtual;               /* on a virtual rig */
    struct wb_specimens specimens; /* of the calibration; n 0: fewer than their scatter needs */
};

struct wb_harness_plan_branch {
    char name[WB_HARNESS_NAME], from[WB_HARNESS_NAME], to[WB_HARNESS_NAME];
    int wire;
    int parent;                                 /* branch; -1: the root */
    double length;                              /* m */
    double leaving[4];                          /* unit quaternion */
    int n_curve;                                /* 0: straight */
    double place[WB_HARNESS_MOST_CURVE];        /* m, ascending */
    double curvature[WB_HARNESS_MOST_CURVE][2]; /* about y, z, 1/m */
    double least_radius;                        /* limit, m; 0: none */
};

enum wb_harness_item_kind {
    WB_HARNESS_ROOT,
    WB_HARNESS_CONNECTOR,
    WB_HARNESS_CLIP
};

/* What can be mounted. Item 0 is the root. */
struct wb_harness_item {
    char name[WB_HARNESS_NAME];
    enum wb_harness_item_kind kind;
    int branch; /* -1: the root */
    double at;  /* m, along the branch */
    enum wb_harness_hold hold;
    double friction;                      /* coefficient, where the wire slides */
    double mass, centre[3];               /* kg, m; of a connector */
    double largest_force, largest_moment; /* limits, N, N m; 0: none */
};

struct wb_harness_plan_obstacle {
    char name[WB_HARNESS_NAME];
    struct wb_obstacle body;
};

/* The words of `shape`, by enum wb_obstacle_kind; NULL at the end. */
extern const char *const wb_harness_file_shapes[];

enum wb_harness_step_kind {
    WB_HARNESS_HANG,
    WB_HARNESS_MOUNT,
    WB_HARNESS_MOVE,
    WB_HARNESS_RELEASE,
    WB_HARNESS_TAKE_OFF
};

struct wb_harness_step {
    enum wb_harness_step_kind kind;
    int item;
    double position[3]; /* m */
    bool has_direction, has_up;
    double direction[3], up[3]; /* unit vectors */
    char name[100];             /* "mount C1" */
};

struct wb_harness_plan {
    char path[WB_PATH];
    char sha256[WB_SHA256_TEXT];
    char name[WB_HARNESS_NAME], title[160];
    double gravity[3];       /* m/s2 */
    struct wb_rod_node root; /* position and rotation */
    int n_wires, n_branches, n_items, n_obstacles, n_steps;
    struct wb_harness_wire wires[WB_HARNESS_MOST_WIRES];
    struct wb_harness_plan_branch branches[WB_HARNESS_MOST_BRANCHES];
    struct wb_harness_item items[WB_HARNESS_MOST_ITEMS];
    struct wb_harness_plan_obstacle obstacles[WB_HARNESS_MOST_OBSTACLES];
    struct wb_harness_step steps[WB_HARNESS_MOST_STEPS];
};

/* Reads a file and the files of its wires. Errors name file, line and key. The plan is large:
 * allocate it. */
WB_MUST_CHECK enum wb_status wb_harness_file_read(struct wb_harness_plan *plan, const char *path);

/* What a step begins with: what is mounted, and where. */
struct wb_harness_assembly {
    bool hangs, is_off;
    bool is_mounted[WB_HARNESS_MOST_ITEMS];
    double place[WB_HARNESS_MOST_ITEMS][3]; /* m, of what is mounted */
};

/* Reads a step from its node, which may be a line of JSON. `beside`: a further key, which is not
 * read; NULL: none. */
WB_MUST_CHECK enum wb_status wb_harness_file_parse_step(const struct wb_harness_plan *plan,
                                                        const struct wb_config_node *node,
                                                        const char *beside,
                                                        struct wb_harness_step *step);

/* Whether a step is possible; otherwise `why` says why not and *key names the key of a file (NULL:
 * the step). */
WB_MUST_CHECK enum wb_status wb_harness_file_check_step(const struct wb_harness_plan *plan,
                                                        const struct wb_harness_assembly *assembly,
                                                        const struct wb_harness_step *step,
                                                        const char **key, struct wb_reason *why);

/* The assembly before the first step, and after a step. */
void wb_harness_file_begin(const struct wb_harness_plan *plan,
                           struct wb_harness_assembly *assembly);
void wb_harness_file_apply_step(const struct wb_harness_step *step,
                                struct wb_harness_assembly *assembly);

/* What holds the wires: the items, and after them the obstacles. Their number, and the name of one.
 */
int wb_harness_file_n_holders(const struct wb_harness_plan *plan);
const char *wb_harness_file_holder(const struct wb_harness_plan *plan, int index);

/* Index of an item; -1: no such name. */
int wb_harness_file_find_item(const struct wb_harness_plan *plan, const char *name);

/* The rotation of a section with an axis and, where `up` is not NULL, that direction upwards; else
 * the shortest turn of `before`. */
void wb_harness_file_rotation(const double direction[3], const double *up, const double before[4],
                              double rotation[4]);

#endif
