#include "fe/harness/harness.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fe/linear/rod_chain.h"
#include "fe/linear/signature.h"

#define WB_LOG_DOMAIN "harness"

enum {
    MAX_ELEMENTS = 100000,
    DEFAULT_ELEMENTS = 100,
    POINTS = WB_ROD_ELEMENT_POINTS,
    NODES = WB_ROD_ELEMENT_NODES,
    U = WB_ROD_ELEMENT_UNKNOWNS,
    MAX_PARTS = 32 /* of the state */
};

/* Elimination of an element's middle node from its end nodes: d2 = -w - W1 d1 - W3 d3; and of its
 * far joint from its near joint: d3 = y - X d1. */
struct eliminated {
    double w[U], W1[U * U], W3[U * U];
    double y[U], X[U * U];
};

struct element {
    int branch, near; /* joint at its beginning; its far joint is that of its index plus 1 */
    double begin;     /* arc length, m */
    const struct wb_law_section *section;
    struct wb_rod_shape shape;
    size_t history;   /* where the history of its first point begins */
    size_t row;       /* doubles of a point */
    double weight[3]; /* N/m */
};

struct branch {
    double leaving[4];
    double length;
    int parent, first, n; /* its elements */
};

struct joint {
    enum wb_harness_hold hold;
    struct wb_rod_node target;
    double load[U];
    double width; /* length of the wire that belongs to it, m */
};

/* What of a point's section may yield: axial strain and bending. */
struct yielding {
    double force[3], plastic[3];
};

struct wb_harness {
    int n_branches, n_elements, n_joints, n_points;
    int n_bodies;
    struct branch *branches;
    struct element *elements;
    struct wb_harness_body *bodies;
    struct joint *joints;
    double length;                   /* of all branches, m */
    double gravity[3], lever, noise; /* lever: 1/m, makes moments forces */
    double drag, carried;
    double weight; /* its factor in the last evaluation */
    size_t history_size;

    /* Strains of the points, (n_points) each: `natural` of the stress-free shape, the others
     * relative to it. `earlier` is the state committed before `committed`. */
    struct wb_rod_strain *natural, *trial, *committed, *earlier;
    struct wb_rod_node root, committed_root, earlier_root;
    struct yielding *yielding; /* (n_points) of the committed state */
    double plastic_work;
    double *history, *trial_history;

    struct wb_rod_node *nodes; /* (3 n_elements) of the trial state */
    /* (n_joints, n_elements) the nodes, and their motion in the last committed step. */
    struct wb_rod_node *committed_nodes, *committed_middles;
    double (*motion)[U], (*middle_motion)[U];
    struct wb_rod_point *points;   /* (n_points) */
    double (*residual)[U];         /* (n_joints) */
    double (*middle)[U];           /* (n_elements) residual of the middle nodes */
    struct eliminated *eliminated; /* (n_elements) */
    double (*diagonal)[U * U];     /* (n_joints) */
    double (*increment)[U];        /* (n_joints) right-hand side, then the solution */
    int negative;
    struct wb_memory memory; /* of all arrays */
};

/* --- the model --- */

static enum wb_status check_branch(const struct wb_harness_model *model, int i)
{
    const struct wb_harness_branch *const b = &model->branches[i];
    if (b->parent < -1 || b->parent >= i)
        return wb_fail(WB_ERR_ARGUMENT, "branch %d: parent %d: expected a branch before it", i,
                       b->parent);
    if (!b->section)
        return wb_fail(WB_ERR_ARGUMENT, "branch %d has no section", i);
    if (!(isfinite(b->length) && b->length > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "branch %d: length %g m: expected a number above 0", i,
                       b->length);
    if (!(isfinite(b->mass) && b->mass >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "branch %d: mass %g kg/m: expected 0 or more", i, b->mass);
    double before = 0.0;
    for (int k = 0; k < b->n_stations; k++) {
        if (!(b->stations[k] > before && b->stations[k] < b->length))
            return wb_fail(WB_ERR_ARGUMENT,
                           "branch %d: a place at %g m: expected above %g m and below %g m", i,
                           b->stations[k], before, b->length);
        before = b->stations[k];
    }
    return WB_OK;
}

static enum wb_status check_model(const struct wb_harness_model *model)
{
    if (model->n_branches < 1)
        return wb_fail(WB_ERR_ARGUMENT, "the harness has no branches");
    for (int i = 0; i < model->n_branches; i++)
        WB_TRY(check_branch(model, i));
    for (int i = 0; i < model->n_bodies; i++) {
        const struct wb_harness_body *const body = &model->bodies[i];
        if (body->branch < 0 || body->branch >= model->n_branches ||
            !(isfinite(body->mass) && body->mass >= 0.0))
            return wb_fail(WB_ERR_ARGUMENT,
                           "body %d: mass %g kg at branch %d: expected 0 or more, at a branch", i,
                           body->mass, body->branch);
    }
    const double *const g = model->gravity;
    if (!(isfinite(g[0]) && isfinite(g[1]) && isfinite(g[2])))
        return wb_fail(WB_ERR_ARGUMENT, "gravity (%g, %g, %g) m/s2 is not finite", g[0], g[1],
                       g[2]);
    if (!(isfinite(model->element_length) && model->element_length >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "element length %g m: expected above 0",
                       model->element_length);
    return WB_OK;
}

/* Ends of the pieces between a branch's stations. */
static double station(const struct wb_harness_branch *branch, int i)
{
    return i < 0 ? 0.0 : i < branch->n_stations ? branch->stations[i] : branch->length;
}

static int elements_in(double length, double most)
{
    /* A length that is a multiple of the element's within round-off needs no further element. */
    return (int)fmax(1.0, ceil(length / most - 1e-9));
}

static double element_length(const struct wb_harness_model *model)
{
    double all = 0.0;
    for (int i = 0; i < model->n_branches; i++)
        all += model->branches[i].length;
    return model->element_length > 0.0 ? model->element_length : all / DEFAULT_ELEMENTS;
}

static double count_elements(const struct wb_harness_model *model)
{
    const double most = element_length(model);
    double n = 0.0;
    for (int i = 0; i < model->n_branches; i++) {
        const struct wb_harness_branch *const b = &model->branches[i];
        for (int k = 0; k <= b->n_stations; k++)
            n += fmax(1.0, ceil((station(b, k) - station(b, k - 1)) / most - 1e-9));
    }
    return n;
}

static void add_piece(struct wb_harness *h, const struct wb_harness_model *model, int branch,
                      int piece)
{
    const struct wb_harness_branch *const b = &model->branches[branch];
    struct branch *const own = &h->branches[branch];
    const double begin = station(b, piece - 1), length = station(b, piece) - begin;
    const int n = elements_in(length, element_length(model));
    for (int i = 0; i < n; i++) {
        const int e = own->first + own->n;
        struct element *const element = &h->elements[e];
        const int parent_end =
            b->parent < 0 ? 0 : h->branches[b->parent].first + h->branches[b->parent].n;
        *element = (struct element){
            .branch = branch,
            .near = own->n == 0 ? parent_end : e,
            .begin = begin + length * i / n,
            .section = b->section,
            .history = h->history_size,
            .row = wb_law_section_history_size(b->section),
        };
        wb_rod_shape_init(&element->shape, length / n);
        for (int k = 0; k < 3; k++)
            element->weight[k] = b->mass * model->gravity[k];
        h->history_size += POINTS * element->row;
        h->joints[element->near].width += length / n / 6.0;
        h->joints[e + 1].width += length / n / 6.0;
        own->n++;
    }
}

static double place_of_point(const struct element *element, int g)
{
    return element->begin +
           element->shape.length * (0.5 + (g % POINTS == 0 ? -0.5 : 0.5) / sqrt(3.0));
}

/* False if a natural curvature is not finite. */
static bool set_natural_shape(struct wb_harness *h, const struct wb_harness_model *model)
{
    for (int g = 0; g < h->n_points; g++) {
        const struct element *const element = &h->elements[g / POINTS];
        const struct wb_harness_branch *const b = &model->branches[element->branch];
        double *const k = h->natural[g].curvature;
        h->natural[g].stretch[0] = 1.0;
        if (b->natural_curvature)
            b->natural_curvature(b->curvature_context, place_of_point(element, g), k);
        if (!(isfinite(k[0]) && isfinite(k[1]) && isfinite(k[2])))
            return false;
        h->points[g].shear_stiffness = wb_law_section_stiffness(element->section).shear;
    }
    return true;
}

static void take_mesh_memory(struct wb_harness *h)
{
    h->branches = wb_memory_take(&h->memory, (size_t)h->n_branches, sizeof *h->branches);
    h->elements = wb_memory_take(&h->memory, (size_t)h->n_elements, sizeof *h->elements);
    h->bodies = wb_memory_take(&h->memory, (size_t)h->n_bodies, sizeof *h->bodies);
    h->joints = wb_memory_take(&h->memory, (size_t)h->n_joints, sizeof *h->joints);
}

static void take_state_memory(struct wb_harness *h)
{
    const size_t elements = (size_t)h->n_elements, points = (size_t)h->n_points;
    const size_t joints = (size_t)h->n_joints;
    struct wb_memory *const m = &h->memory;

    h->natural = wb_memory_take(m, points, sizeof *h->natural);
    h->trial = wb_memory_take(m, points, sizeof *h->trial);
    h->committed = wb_memory_take(m, points, sizeof *h->committed);
    h->earlier = wb_memory_take(m, points, sizeof *h->earlier);
    h->history = wb_memory_take(m, h->history_size, sizeof *h->history);
    h->trial_history = wb_memory_take(m, h->history_size, sizeof *h->trial_history);
    h->yielding = wb_memory_take(m, points, sizeof *h->yielding);
    h->nodes = wb_memory_take(m, NODES * elements, sizeof *h->nodes);
    h->committed_nodes = wb_memory_take(m, joints, sizeof *h->committed_nodes);
    h->committed_middles = wb_memory_take(m, elements, sizeof *h->committed_middles);
    h->motion = wb_memory_take(m, joints, sizeof *h->motion);
    h->middle_motion = wb_memory_take(m, elements, sizeof *h->middle_motion);
    h->points = wb_memory_take(m, points, sizeof *h->points);
    h->residual = wb_memory_take(m, joints, sizeof *h->residual);
    h->middle = wb_memory_take(m, elements, sizeof *h->middle);
    h->eliminated = wb_memory_take(m, elements, sizeof *h->eliminated);
    h->diagonal = wb_memory_take(m, joints, sizeof *h->diagonal);
    h->increment = wb_memory_take(m, joints, sizeof *h->increment);
}

/* --- mesh and holds --- */

int wb_harness_n_joints(const struct wb_harness *harness)
{
    return harness->n_joints;
}

int wb_harness_joint(const struct wb_harness *h, int branch, double arc_length)
{
    const struct branch *const b = &h->branches[branch];
    int best = h->elements[b->first].near;
    double nearest = fabs(arc_length);
    for (int e = b->first; e < b->first + b->n; e++) {
        const double end = h->elements[e].begin + h->elements[e].shape.length;
        if (fabs(arc_length - end) < nearest) {
            nearest = fabs(arc_length - end);
            best = e + 1;
        }
    }
    return best;
}

int wb_harness_place_of(const struct wb_harness *h, int joint, double *arc_length)
{
    *arc_length = 0.0;
    if (joint == 0)
        return -1;
    const struct element *const element = &h->elements[joint - 1];
    *arc_length = element->begin + element->shape.length;
    return element->branch;
}

void wb_harness_set_hold(struct wb_harness *h, int joint, enum wb_harness_hold hold,
                         const struct wb_rod_node *target)
{
    h->joints[joint].hold = hold;
    if (hold != WB_HARNESS_FREE)
        h->joints[joint].target = *target;
}

enum wb_harness_hold wb_harness_hold(const struct wb_harness *harness, int joint)
{
    return harness->joints[joint].hold;
}

void wb_harness_set_load(struct wb_harness *harness, int joint, const double load[6])
{
    memcpy(harness->joints[joint].load, load, U * sizeof *load);
}

void wb_harness_load(const struct wb_harness *harness, int joint, double load[6])
{
    memcpy(load, harness->joints[joint].load, U * sizeof *load);
}

void wb_harness_set_drag(struct wb_harness *harness, double drag, double carried)
{
    harness->drag = drag;
    harness->carried = carried;
}

/* --- placing and creation --- */

static const struct wb_rod_node *node_of(const struct wb_harness *h, int joint)
{
    return joint == 0 ? &h->root : &h->nodes[NODES * (joint - 1) + 2];
}

const struct wb_rod_node *wb_harness_node(const struct wb_harness *harness, int joint)
{
    return node_of(harness, joint);
}

/* Total strains of an element's points, including those of the stress-free shape. */
static void total_strain(const struct wb_harness *h, int e, struct wb_rod_strain *total)
{
    for (int g = 0; g < POINTS; g++) {
        const struct wb_rod_strain *const at = &h->trial[e * POINTS + g];
        total[g] = h->natural[e * POINTS + g];
        for (int k = 0; k < 3; k++) {
            total[g].stretch[k] += at->stretch[k];
            total[g].curvature[k] += at->curvature[k];
        }
    }
}

static void place(struct wb_harness *h)
{
    for (int e = 0; e < h->n_elements; e++) {
        const struct element *const element = &h->elements[e];
        const struct branch *const branch = &h->branches[element->branch];
        struct wb_rod_node *const nodes = h->nodes + NODES * e;
        struct wb_rod_strain total[POINTS];
        nodes[0] = *node_of(h, element->near);
        if (e == branch->first)
            wb_rod_element_compose(nodes[0].rotation, branch->leaving, nodes[0].rotation);
        total_strain(h, e, total);
        wb_rod_element_place(&element->shape, total, nodes, h->points + e * POINTS);
    }
}

enum wb_status wb_harness_create(struct wb_harness **out, const struct wb_harness_model *model)
{
    *out = NULL;
    WB_TRY(check_model(model));
    const double n_elements = count_elements(model);
    if (n_elements > MAX_ELEMENTS)
        return wb_fail(WB_ERR_ARGUMENT, "%.0f elements: expected at most %d", n_elements,
                       MAX_ELEMENTS);

    struct wb_harness *const h = wb_memory_new(1, sizeof *h);
    h->n_branches = model->n_branches;
    h->n_bodies = model->n_bodies;
    h->n_elements = (int)n_elements;
    h->n_joints = h->n_elements + 1;
    h->n_points = POINTS * h->n_elements;
    h->lever = 1.0 / element_length(model);
    memcpy(h->gravity, model->gravity, sizeof h->gravity);
    take_mesh_memory(h);
    for (int i = 0, first = 0; i < h->n_branches; i++) {
        const struct wb_harness_branch *const b = &model->branches[i];
        struct branch *const own = &h->branches[i];
        *own = (struct branch){.length = b->length, .parent = b->parent, .first = first};
        memcpy(own->leaving, b->leaving, sizeof own->leaving);
        for (int piece = 0; piece <= b->n_stations; piece++)
            add_piece(h, model, i, piece);
        first += own->n;
        h->length += b->length;
        /* See wb_beam_noise(). */
        h->noise = fmax(h->noise, 3e-2 * DBL_EPSILON * wb_law_section_stiffness(b->section).axial);
    }
    for (int i = 0; i < h->n_bodies; i++)
        h->bodies[i] = model->bodies[i];
    take_state_memory(h);
    if (!set_natural_shape(h, model)) {
        wb_harness_destroy(h);
        return wb_fail(WB_ERR_ARGUMENT, "a natural curvature is not finite");
    }
    h->joints[0].hold = WB_HARNESS_FIXED;
    h->joints[0].target = h->root = h->committed_root = h->earlier_root = model->root;
    place(h);
    for (int j = 0; j < h->n_joints; j++)
        h->committed_nodes[j] = *node_of(h, j);
    for (int e = 0; e < h->n_elements; e++)
        h->committed_middles[e] = h->nodes[NODES * e + 1];
    *out = h;
    return WB_OK;
}

void wb_harness_destroy(struct wb_harness *harness)
{
    if (!harness)
        return;
    wb_memory_release(&harness->memory);
    free(harness);
}

static void copy_strains(const struct wb_harness *h, struct wb_rod_strain *to,
                         const struct wb_rod_strain *from)
{
    memcpy(to, from, (size_t)h->n_points * sizeof *to);
}

/* --- evaluation --- */

/* As fmax(), but returns NaN if either argument is NaN. */
static double larger(double a, double b)
{
    return b > a || b != b ? b : a;
}

static double size_of(const double *force, double lever)
{
    const double linear = larger(larger(fabs(force[0]), fabs(force[1])), fabs(force[2]));
    const double moment = larger(larger(fabs(force[3]), fabs(force[4])), fabs(force[5]));
    return larger(linear, lever * moment);
}

static void evaluate_point(struct wb_harness *h, const struct element *element, int g)
{
    const struct wb_rod_strain *const at = &h->trial[g];
    struct wb_rod_point *const p = &h->points[g];
    const size_t row = element->history + (size_t)(g % POINTS) * element->row;
    double strain[WB_ROD_SECTION_STRAINS];

    strain[0] = at->stretch[0];
    memcpy(strain + 1, at->curvature, sizeof at->curvature);
    wb_law_section_respond(element->section, strain, h->history + row, h->trial_history + row,
                           &p->section);
    wb_rod_element_turn_forces(p, at->stretch + 1);
}

static void add_element(struct wb_harness *h, int e, double weight,
                        struct wb_harness_balance *balance)
{
    /* A weight consistent with quadratic motions: 1/6, 4/6, 1/6 of an element's. */
    static const double parts[NODES] = {1.0, 4.0, 1.0};
    const struct element *const element = &h->elements[e];
    double f[U * NODES] = {0};
    for (int g = 0; g < POINTS; g++) {
        evaluate_point(h, element, e * POINTS + g);
        wb_rod_element_add_forces(&element->shape, g, &h->points[e * POINTS + g], f);
    }
    double *const to[NODES] = {h->residual[element->near], h->middle[e], h->residual[e + 1]};
    for (int i = 0; i < NODES; i++) {
        balance->largest_force = larger(balance->largest_force, size_of(f + U * i, h->lever));
        const double share = weight * parts[i] * element->shape.length / 6.0;
        for (int k = 0; k < U; k++)
            to[i][k] += f[U * i + k] - (k < 3 ? share * element->weight[k] : 0.0);
    }
}

/* Where a body's weight acts, relative to its joint, in space; and the weight. */
static int body_arm(const struct wb_harness *h, const struct wb_harness_body *body, double arm[3],
                    double force[3])
{
    const struct branch *const b = &h->branches[body->branch];
    const int joint = b->first + b->n;
    double R[9];
    wb_rod_element_matrix(node_of(h, joint)->rotation, R);
    for (int i = 0; i < 3; i++) {
        arm[i] = wb_vec3_dot(R + 3 * i, body->centre);
        force[i] = body->mass * h->gravity[i];
    }
    return joint;
}

static void add_bodies(struct wb_harness *h, double weight)
{
    for (int i = 0; i < h->n_bodies; i++) {
        double arm[3], force[3], moment[3];
        double *const r = h->residual[body_arm(h, &h->bodies[i], arm, force)];
        wb_vec3_cross(arm, force, moment);
        for (int k = 0; k < 3; k++) {
            r[k] -= weight * force[k];
            r[3 + k] -= weight * moment[k];
        }
    }
}

/* The drag of a node's part of the wire, over its coefficient; against rotation with half the part
 * as its arm. */
static double part_of(double width, int component)
{
    return component < 3 ? width : 0.25 * width * width * width;
}

/* Way and rotation vector between two states of a node. */
static void motion_of(const struct wb_rod_node *was, const struct wb_rod_node *now,
                      double motion[U])
{
    for (int k = 0; k < 3; k++)
        motion[k] = now->position[k] - was->position[k];
    wb_rod_element_turn_between(was->rotation, now->rotation, motion + 3);
}

static void add_drag_of(const struct wb_harness *h, double width, const struct wb_rod_node *was,
                        const struct wb_rod_node *now, const double *before, double *residual)
{
    double motion[U];
    motion_of(was, now, motion);
    for (int k = 0; k < U; k++)
        residual[k] += part_of(width, k) * (h->drag * motion[k] - h->carried * before[k]);
}

static double middle_width(const struct element *element)
{
    return 4.0 / 6.0 * element->shape.length;
}

static const struct wb_rod_node *middle_node(const struct wb_harness *h, int e)
{
    return &h->nodes[NODES * e + 1];
}

static void add_drag(struct wb_harness *h)
{
    for (int j = 0; j < h->n_joints; j++)
        add_drag_of(h, h->joints[j].width, &h->committed_nodes[j], node_of(h, j), h->motion[j],
                    h->residual[j]);
    for (int e = 0; e < h->n_elements; e++)
        add_drag_of(h, middle_width(&h->elements[e]), &h->committed_middles[e], middle_node(h, e),
                    h->middle_motion[e], h->middle[e]);
}

/* How a joint is held: the axes of the bases of its position and of its spin (rows), which of its
 * six components there are held, and their way to the target. */
struct held {
    double axes[2][9];
    bool is[U];
    double way[U];
};

/* c = A b and c = A^T b */
static void turn(const double *A, const double *b, double *c)
{
    for (int i = 0; i < 3; i++)
        c[i] = wb_vec3_dot(A + 3 * i, b);
}

static void turn_back(const double *A, const double *b, double *c)
{
    for (int i = 0; i < 3; i++)
        c[i] = A[i] * b[0] + A[3 + i] * b[1] + A[6 + i] * b[2];
}

/* The shortest rotation vector that turns the axis of one rotation to that of another. */
static void turn_axis(const double *from, const double *to, double vector[3])
{
    double R[9], aim[9];
    wb_rod_element_matrix(from, R);
    wb_rod_element_matrix(to, aim);
    const double axis[3] = {R[0], R[3], R[6]}, wanted[3] = {aim[0], aim[3], aim[6]};
    wb_vec3_cross(axis, wanted, vector);
    const double sine = wb_vec3_length(vector), cosine = wb_vec3_dot(axis, wanted);
    if (sine < 1e-12 && cosine < 0.0) {
        /* Opposite: about any axis across. */
        for (int k = 0; k < 3; k++)
            vector[k] = M_PI * R[3 * k + 1];
        return;
    }
    for (int k = 0; k < 3; k++)
        vector[k] *= sine < 1e-12 ? 1.0 : atan2(sine, cosine) / sine;
}

void wb_harness_turn_to(const struct wb_harness *harness, int joint, const struct wb_rod_node *from,
                        const struct wb_rod_node *to, double vector[3])
{
    memset(vector, 0, 3 * sizeof *vector);
    if (harness->joints[joint].hold == WB_HARNESS_FIXED)
        wb_rod_element_turn_between(from->rotation, to->rotation, vector);
    else if (harness->joints[joint].hold == WB_HARNESS_AXIS)
        turn_axis(from->rotation, to->rotation, vector);
}

/* Rows of the basis: the columns of a rotation. */
static void set_axes(double *axes, const double *rotation)
{
    double R[9];
    wb_rod_element_matrix(rotation, R);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            axes[3 * i + k] = R[3 * k + i];
    }
}

static void look_at_hold(const struct wb_harness *h, int joint, struct held *held)
{
    static const double space[4] = {1.0, 0.0, 0.0, 0.0};
    const struct joint *const j = &h->joints[joint];
    const struct wb_rod_node *const now = node_of(h, joint);
    double way[3], spin[3];
    *held = (struct held){0};
    if (j->hold == WB_HARNESS_FREE)
        return;
    set_axes(held->axes[0], j->hold == WB_HARNESS_PLANE ? j->target.rotation : space);
    set_axes(held->axes[1], j->hold == WB_HARNESS_AXIS ? now->rotation : space);
    wb_harness_turn_to(h, joint, now, &j->target, spin);
    for (int k = 0; k < 3; k++)
        way[k] = j->target.position[k] - now->position[k];
    for (int k = 0; k < 3; k++) {
        held->is[k] = j->hold != WB_HARNESS_PLANE || k == 0;
        held->is[3 + k] = j->hold == WB_HARNESS_FIXED || (j->hold == WB_HARNESS_AXIS && k > 0);
        held->way[k] = held->is[k] ? wb_vec3_dot(held->axes[0] + 3 * k, way) : 0.0;
        held->way[3 + k] = held->is[3 + k] ? wb_vec3_dot(held->axes[1] + 3 * k, spin) : 0.0;
    }
}

/* Components of a vector of position and spin, from space to the bases or back. */
static void turn_vector(const struct held *held, bool back, double *vector)
{
    for (int half = 0; half < 2; half++) {
        double *const v = vector + 3 * half, turned[3];
        if (back)
            turn_back(held->axes[half], v, turned);
        else
            turn(held->axes[half], v, turned);
        memcpy(v, turned, sizeof turned);
    }
}

static void check_joint(const struct wb_harness *h, int joint, struct wb_harness_balance *balance)
{
    double left[U];
    memcpy(left, h->residual[joint], sizeof left);
    if (h->joints[joint].hold != WB_HARNESS_FREE) {
        struct held held;
        look_at_hold(h, joint, &held);
        turn_vector(&held, false, left);
        for (int k = 0; k < U; k++)
            left[k] = held.is[k] ? 0.0 : left[k];
        balance->farthest_hold = larger(balance->farthest_hold, wb_vec3_length(held.way));
        balance->farthest_turn = larger(balance->farthest_turn, wb_vec3_length(held.way + 3));
    }
    const double size = size_of(left, h->lever);
    if (size > balance->largest_residual || size != size) {
        balance->largest_residual = size;
        balance->worst_joint = joint;
    }
}

void wb_harness_evaluate(struct wb_harness *h, double weight, struct wb_harness_balance *balance)
{
    *balance = (struct wb_harness_balance){0};
    for (int j = 0; j < h->n_joints; j++) {
        for (int k = 0; k < U; k++)
            h->residual[j][k] = -h->joints[j].load[k];
    }
    memset(h->middle, 0, (size_t)h->n_elements * sizeof *h->middle);
    for (int e = 0; e < h->n_elements; e++)
        add_element(h, e, weight, balance);
    add_bodies(h, weight);
    if (h->drag > 0.0)
        add_drag(h);
    for (int j = 0; j < h->n_joints; j++)
        check_joint(h, j, balance);
    for (int e = 0; e < h->n_elements; e++) {
        const double size = size_of(h->middle[e], h->lever);
        if (size > balance->largest_residual || size != size) {
            balance->largest_residual = size;
            balance->worst_joint = e + 1;
        }
    }
    h->weight = weight;
}

void wb_harness_reaction(const struct wb_harness *harness, int joint, double reaction[6])
{
    memcpy(reaction, harness->residual[joint], U * sizeof *reaction);
}

/* --- Newton's increment --- */

/* Eliminates an element's middle node. `upper` becomes the block of its far joint's row and near
 * joint's column, `lower` that of the opposite; the diagonal blocks and right-hand sides are added.
 */
static void condense_element(struct wb_harness *h, int e, double *upper, double *lower)
{
    const struct element *const element = &h->elements[e];
    struct eliminated *const m = &h->eliminated[e];
    struct wb_rod_element_stiffness s;
    double rows[U][WB_ROD_CHAIN_WIDTH] = {{0}};

    wb_rod_element_stiffness(&element->shape, &h->points[e * POINTS], &s);
    for (int k = 0; k < U && h->drag > 0.0; k++)
        s.K[1][1][(U + 1) * k] += part_of(middle_width(element), k) * h->drag;
    h->negative += wb_signature_negative(U, U, s.K[1][1]);
    for (int r = 0; r < U; r++) {
        memcpy(rows[r], s.K[1][1] + U * r, U * sizeof(double));
        memcpy(rows[r] + U, s.K[1][2] + U * r, U * sizeof(double));
        rows[r][2 * U] = h->middle[e][r];
        memcpy(rows[r] + 2 * U + 1, s.K[1][0] + U * r, U * sizeof(double));
    }
    wb_rod_chain_solve(rows, 2 * U + 1);
    for (int r = 0; r < U; r++) {
        memcpy(m->W3 + U * r, rows[r] + U, U * sizeof(double));
        m->w[r] = rows[r][2 * U];
        memcpy(m->W1 + U * r, rows[r] + 2 * U + 1, U * sizeof(double));
    }
    const int near = element->near, far = e + 1;
    for (int k = 0; k < U * U; k++) {
        upper[k] = s.K[2][0][k];
        lower[k] = s.K[0][2][k];
        h->diagonal[near][k] += s.K[0][0][k];
        h->diagonal[far][k] += s.K[2][2][k];
    }
    wb_rod_chain_multiply(upper, -1.0, s.K[2][1], m->W1);
    wb_rod_chain_multiply(lower, -1.0, s.K[0][1], m->W3);
    wb_rod_chain_multiply(h->diagonal[near], -1.0, s.K[0][1], m->W1);
    wb_rod_chain_multiply(h->diagonal[far], -1.0, s.K[2][1], m->W3);
    wb_rod_chain_apply(h->increment[near], 1.0, s.K[0][1], m->w);
    wb_rod_chain_apply(h->increment[far], 1.0, s.K[2][1], m->w);
}

/* Rows of a block from space to the bases or back. */
static void turn_rows(const struct held *held, bool back, double *block)
{
    for (int c = 0; c < U; c++) {
        double column[U];
        for (int r = 0; r < U; r++)
            column[r] = block[U * r + c];
        turn_vector(held, back, column);
        for (int r = 0; r < U; r++)
            block[U * r + c] = column[r];
    }
}

/* Solves for a joint's increment in terms of that of the near joint: `upper` (NULL: none) becomes
 * X, the right-hand side y. */
static void eliminate_joint(struct wb_harness *h, int joint, double *upper)
{
    double *const S = h->diagonal[joint], *const g = h->increment[joint];
    const enum wb_harness_hold hold = h->joints[joint].hold;
    const bool turned = hold == WB_HARNESS_PLANE || hold == WB_HARNESS_AXIS;
    struct held held;
    double rows[U][WB_ROD_CHAIN_WIDTH] = {{0}}, free_part[U * U];

    look_at_hold(h, joint, &held);
    if (turned) {
        turn_rows(&held, false, S);
        for (int r = 0; r < U; r++)
            turn_vector(&held, false, S + U * r);
        turn_vector(&held, false, g);
        if (upper)
            turn_rows(&held, false, upper);
    }
    for (int r = 0; r < U; r++) {
        if (held.is[r]) {
            rows[r][r] = 1.0;
            rows[r][2 * U] = held.way[r];
            continue;
        }
        memcpy(rows[r], S + U * r, U * sizeof(double));
        if (upper)
            memcpy(rows[r] + U, upper + U * r, U * sizeof(double));
        rows[r][2 * U] = g[r];
    }
    for (int r = 0; r < U; r++) {
        for (int c = 0; c < U; c++)
            free_part[U * r + c] = held.is[c] && r != c ? 0.0 : rows[r][c];
    }
    h->negative += wb_signature_negative(U, U, free_part);
    wb_rod_chain_solve(rows, U + 1);
    for (int r = 0; r < U; r++) {
        if (upper)
            memcpy(upper + U * r, rows[r] + U, U * sizeof(double));
        g[r] = rows[r][2 * U];
    }
    if (turned) {
        turn_vector(&held, true, g);
        if (upper)
            turn_rows(&held, true, upper);
    }
}

/* The stiffness of a body's weight, which turns with its joint: d(arm x f) = (arm f^T - arm . f)
 * spin. */
static void add_body_stiffness(struct wb_harness *h)
{
    for (int i = 0; i < h->n_bodies; i++) {
        double arm[3], f[3];
        double *const S = h->diagonal[body_arm(h, &h->bodies[i], arm, f)];
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++)
                S[U * (3 + r) + 3 + c] -=
                    h->weight * (arm[r] * f[c] - (r == c ? wb_vec3_dot(arm, f) : 0.0));
        }
    }
}

static void add_drag_stiffness(struct wb_harness *h)
{
    for (int j = 0; j < h->n_joints; j++) {
        for (int k = 0; k < U; k++)
            h->diagonal[j][(U + 1) * k] += part_of(h->joints[j].width, k) * h->drag;
    }
}

void wb_harness_solve(struct wb_harness *h)
{
    double lower[U * U];
    h->negative = 0;
    memset(h->diagonal, 0, (size_t)h->n_joints * sizeof *h->diagonal);
    for (int j = 0; j < h->n_joints; j++) {
        for (int k = 0; k < U; k++)
            h->increment[j][k] = -h->residual[j][k];
    }
    add_body_stiffness(h);
    if (h->drag > 0.0)
        add_drag_stiffness(h);
    for (int e = h->n_elements - 1; e >= 0; e--) {
        struct eliminated *const m = &h->eliminated[e];
        const int near = h->elements[e].near;
        condense_element(h, e, m->X, lower);
        eliminate_joint(h, e + 1, m->X);
        memcpy(m->y, h->increment[e + 1], sizeof m->y);
        wb_rod_chain_multiply(h->diagonal[near], -1.0, lower, m->X);
        wb_rod_chain_apply(h->increment[near], -1.0, lower, m->y);
    }
    eliminate_joint(h, 0, NULL);
    for (int e = 0; e < h->n_elements; e++)
        wb_rod_chain_apply(h->increment[e + 1], -1.0, h->eliminated[e].X,
                           h->increment[h->elements[e].near]);
}

int wb_harness_negative(const struct wb_harness *harness)
{
    return harness->negative;
}

static void advance_element(struct wb_harness *h, int e, double scale)
{
    const struct element *const element = &h->elements[e];
    const struct eliminated *const m = &h->eliminated[e];
    double own[NODES * U];
    memcpy(own, h->increment[element->near], U * sizeof(double));
    memcpy(own + 2 * U, h->increment[e + 1], U * sizeof(double));
    for (int k = 0; k < U; k++)
        own[U + k] = -m->w[k];
    wb_rod_chain_apply(own + U, -1.0, m->W1, own);
    wb_rod_chain_apply(own + U, -1.0, m->W3, own + 2 * U);
    for (int g = 0; g < POINTS; g++) {
        struct wb_rod_strain change;
        struct wb_rod_strain *const at = &h->trial[e * POINTS + g];
        wb_rod_element_strain_increment(&element->shape, g, &h->points[e * POINTS + g], own,
                                        &change);
        for (int k = 0; k < 3; k++) {
            at->stretch[k] += scale * change.stretch[k];
            at->curvature[k] += scale * change.curvature[k];
        }
    }
}

static void turn_root(struct wb_harness *h, const double *spin)
{
    double q[4];
    wb_rod_element_exponential(spin, q);
    wb_rod_element_compose(q, h->root.rotation, h->root.rotation);
}

/* The increment changes strains and moves the root; positions and rotations follow from them, for
 * the reasons given in beam.c. */
double wb_harness_advance(struct wb_harness *h, double most_rotation)
{
    double most = 0.0, spin[3];
    for (int j = 0; j < h->n_joints; j++)
        most = larger(most, wb_vec3_length(h->increment[j] + 3));
    const double scale = most > most_rotation ? most_rotation / most : 1.0;
    for (int e = 0; e < h->n_elements; e++)
        advance_element(h, e, scale);
    for (int k = 0; k < 3; k++) {
        h->root.position[k] += scale * h->increment[0][k];
        spin[k] = scale * h->increment[0][3 + k];
    }
    turn_root(h, spin);
    place(h);
    return scale;
}

/* --- history --- */

static void remember_nodes(struct wb_harness *h)
{
    for (int j = 0; j < h->n_joints; j++) {
        motion_of(&h->committed_nodes[j], node_of(h, j), h->motion[j]);
        h->committed_nodes[j] = *node_of(h, j);
    }
    for (int e = 0; e < h->n_elements; e++) {
        motion_of(&h->committed_middles[e], middle_node(h, e), h->middle_motion[e]);
        h->committed_middles[e] = *middle_node(h, e);
    }
}

void wb_harness_revert(struct wb_harness *h)
{
    copy_strains(h, h->trial, h->committed);
    h->root = h->committed_root;
    place(h);
}

void wb_harness_extrapolate(struct wb_harness *h, double ratio)
{
    for (int g = 0; g < h->n_points; g++) {
        const struct wb_rod_strain now = h->committed[g], was = h->earlier[g];
        for (int k = 0; k < 3; k++) {
            h->trial[g].stretch[k] = now.stretch[k] + ratio * (now.stretch[k] - was.stretch[k]);
            h->trial[g].curvature[k] =
                now.curvature[k] + ratio * (now.curvature[k] - was.curvature[k]);
        }
    }
    double spin[3];
    h->root = h->committed_root;
    wb_rod_element_turn_between(h->earlier_root.rotation, h->committed_root.rotation, spin);
    for (int k = 0; k < 3; k++) {
        h->root.position[k] +=
            ratio * (h->committed_root.position[k] - h->earlier_root.position[k]);
        spin[k] *= ratio;
    }
    turn_root(h, spin);
    place(h);
}

/* The plastic work of the step, by the trapezoidal rule. */
static void add_plastic_work(struct wb_harness *h)
{
    for (int g = 0; g < h->n_points; g++) {
        const struct element *const element = &h->elements[g / POINTS];
        const struct wb_law_section_stiffness k = wb_law_section_stiffness(element->section);
        const double stiffness[3] = {k.axial, k.bending, k.bending};
        const double *const f = h->points[g].section.force;
        const double force[3] = {f[0], f[2], f[3]};
        const struct wb_rod_strain *const at = &h->trial[g];
        const double strain[3] = {at->stretch[0], at->curvature[1], at->curvature[2]};
        struct yielding *const y = &h->yielding[g];
        for (int i = 0; i < 3; i++) {
            const double plastic = strain[i] - force[i] / stiffness[i];
            h->plastic_work +=
                0.5 * element->shape.weight * (y->force[i] + force[i]) * (plastic - y->plastic[i]);
            y->force[i] = force[i];
            y->plastic[i] = plastic;
        }
    }
}

void wb_harness_commit(struct wb_harness *h)
{
    struct wb_rod_strain *const oldest = h->earlier;
    double *const old = h->history;

    add_plastic_work(h);
    h->earlier = h->committed;
    h->committed = oldest;
    copy_strains(h, h->committed, h->trial);
    h->earlier_root = h->committed_root;
    h->committed_root = h->root;
    h->history = h->trial_history;
    h->trial_history = old;
    remember_nodes(h);
}

/* The parts of the state in the order in which they are saved: all that outlives an evaluation, and
 * the results of the last one. */
struct part {
    void *at;
    size_t size;
};

static size_t list_parts(struct wb_harness *h, struct part parts[MAX_PARTS])
{
    const size_t elements = (size_t)h->n_elements, points = (size_t)h->n_points;
    const size_t joints = (size_t)h->n_joints;
    const struct part list[] = {
        {h->joints, joints * sizeof *h->joints},
        {&h->drag, sizeof h->drag},
        {&h->carried, sizeof h->carried},
        {&h->weight, sizeof h->weight},
        {h->trial, points * sizeof *h->trial},
        {h->committed, points * sizeof *h->committed},
        {h->earlier, points * sizeof *h->earlier},
        {&h->root, sizeof h->root},
        {&h->committed_root, sizeof h->committed_root},
        {&h->earlier_root, sizeof h->earlier_root},
        {h->yielding, points * sizeof *h->yielding},
        {&h->plastic_work, sizeof h->plastic_work},
        {h->history, h->history_size * sizeof *h->history},
        {h->nodes, NODES * elements * sizeof *h->nodes},
        {h->committed_nodes, joints * sizeof *h->committed_nodes},
        {h->committed_middles, elements * sizeof *h->committed_middles},
        {h->motion, joints * sizeof *h->motion},
        {h->middle_motion, elements * sizeof *h->middle_motion},
        {h->points, points * sizeof *h->points},
        {h->residual, joints * sizeof *h->residual},
    };
    _Static_assert(sizeof list / sizeof *list <= MAX_PARTS, "parts of the state");
    memcpy(parts, list, sizeof list);
    return sizeof list / sizeof *list;
}

size_t wb_harness_state_size(const struct wb_harness *harness)
{
    struct part parts[MAX_PARTS];
    size_t size = 0;
    for (size_t i = list_parts((struct wb_harness *)harness, parts); i > 0; i--)
        size += parts[i - 1].size;
    return size;
}

void wb_harness_save(const struct wb_harness *harness, void *state)
{
    struct part parts[MAX_PARTS];
    const size_t n = list_parts((struct wb_harness *)harness, parts);
    for (size_t i = 0, at = 0; i < n; at += parts[i++].size)
        memcpy((char *)state + at, parts[i].at, parts[i].size);
}

void wb_harness_restore(struct wb_harness *harness, const void *state)
{
    struct part parts[MAX_PARTS];
    const size_t n = list_parts(harness, parts);
    for (size_t i = 0, at = 0; i < n; at += parts[i++].size)
        memcpy(parts[i].at, (const char *)state + at, parts[i].size);
}

double wb_harness_turn(const struct wb_harness *h)
{
    double least = 1.0;
    for (int j = 0; j < h->n_joints; j++) {
        const double *const a = h->committed_nodes[j].rotation, *const b = node_of(h, j)->rotation;
        least = fmin(least, fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]));
    }
    return 2.0 * acos(least);
}

/* --- results --- */

struct wb_rod_node wb_harness_position(const struct wb_harness *h, int branch, double arc_length)
{
    const struct branch *const b = &h->branches[branch];
    const double s = fmin(fmax(arc_length, 0.0), b->length);
    int e = b->first;
    while (e + 1 < b->first + b->n && h->elements[e + 1].begin <= s)
        e++;
    const struct element *const element = &h->elements[e];
    const struct wb_rod_node *const node = h->nodes + NODES * e;
    double N[NODES], dN[NODES];
    struct wb_rod_strain total[POINTS];
    struct wb_rod_node at;
    wb_rod_shape_at(2.0 * (s - element->begin) / element->shape.length - 1.0, element->shape.length,
                    N, dN);
    for (int k = 0; k < 3; k++)
        at.position[k] =
            N[0] * node[0].position[k] + N[1] * node[1].position[k] + N[2] * node[2].position[k];
    total_strain(h, e, total);
    wb_rod_element_rotation(&element->shape, total, s - element->begin, node[0].rotation,
                            at.rotation);
    return at;
}

static void add_force(double *sum, const double *force, const double *at)
{
    double moment[3];
    wb_vec3_cross(at, force, moment);
    for (int k = 0; k < 3; k++) {
        sum[k] += force[k];
        sum[3 + k] += moment[k];
    }
}

void wb_harness_weight(const struct wb_harness *h, double weight[6])
{
    static const double parts[NODES] = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
    memset(weight, 0, U * sizeof *weight);
    for (int e = 0; e < h->n_elements; e++) {
        for (int i = 0; i < NODES; i++) {
            double force[3];
            for (int k = 0; k < 3; k++)
                force[k] = parts[i] * h->elements[e].shape.length * h->elements[e].weight[k];
            add_force(weight, force, h->nodes[NODES * e + i].position);
        }
    }
    for (int i = 0; i < h->n_bodies; i++) {
        double arm[3], force[3];
        const int joint = body_arm(h, &h->bodies[i], arm, force);
        for (int k = 0; k < 3; k++)
            arm[k] += node_of(h, joint)->position[k];
        add_force(weight, force, arm);
    }
}

int wb_harness_n_points(const struct wb_harness *harness)
{
    return harness->n_points;
}

void wb_harness_point(const struct wb_harness *h, int index, struct wb_harness_point *point)
{
    const struct element *const element = &h->elements[index / POINTS];
    const struct wb_rod_strain *const at = &h->trial[index], *const natural = &h->natural[index];
    const struct wb_rod_point *const p = &h->points[index];
    *point = (struct wb_harness_point){
        .branch = element->branch,
        .arc_length = place_of_point(element, index),
        .length = element->shape.weight,
        .force = p->section.force[0],
    };
    for (int k = 0; k < 3; k++) {
        point->bending[k] = at->curvature[k];
        point->curvature[k] = at->curvature[k] + natural->curvature[k];
        point->moment[k] = p->section.force[1 + k];
    }
}

double wb_harness_elastic_energy(const struct wb_harness *h)
{
    double energy = 0.0;
    for (int g = 0; g < h->n_points; g++) {
        const struct element *const element = &h->elements[g / POINTS];
        const struct wb_law_section_stiffness k = wb_law_section_stiffness(element->section);
        const double *const f = h->points[g].section.force;
        const double *const shear = h->trial[g].stretch + 1;
        energy += 0.5 * element->shape.weight *
                  (f[0] * f[0] / k.axial + f[1] * f[1] / k.torsion +
                   (f[2] * f[2] + f[3] * f[3]) / k.bending +
                   k.shear * (shear[0] * shear[0] + shear[1] * shear[1]));
    }
    return energy;
}

double wb_harness_plastic_work(const struct wb_harness *harness)
{
    return harness->plastic_work;
}

double wb_harness_length(const struct wb_harness *harness)
{
    return harness->length;
}

void wb_harness_stiffness(const struct wb_harness *h, double *stiffest, double *softest)
{
    *stiffest = 0.0;
    *softest = (double)INFINITY;
    for (int e = 0; e < h->n_elements; e++) {
        const struct element *const element = &h->elements[e];
        const double EI = wb_law_section_stiffness(element->section).bending;
        *stiffest = fmax(*stiffest, EI / pow(element->shape.length, 4.0));
        *softest = fmin(*softest, EI / pow(h->length, 4.0));
    }
}

double wb_harness_noise(const struct wb_harness *h)
{
    double widest = 0.0;
    for (int e = 0; e < h->n_elements && h->drag > 0.0; e++)
        widest = fmax(widest, middle_width(&h->elements[e]));
    /* Positions are rounded. */
    return h->noise + 4.0 * DBL_EPSILON * h->drag * widest * h->length;
}
