#include "fe/harness/harness.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fe/harness/harness_contact.h"
#include "fe/harness/harness_state.h"

#define WB_LOG_DOMAIN "harness"

enum {
    MAX_ELEMENTS = 100000,
    DEFAULT_ELEMENTS = 100,
    MAX_PARTS = 32 /* of the state */
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
    if (!(isfinite(b->radius) && b->radius >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "branch %d: radius %g m: expected 0 or more", i, b->radius);
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
    if (model->most_sliding < 0 || model->most_sliding > WB_HARNESS_MOST_SLIDING)
        return wb_fail(WB_ERR_ARGUMENT, "%d sliding clips: expected at most %d",
                       model->most_sliding, WB_HARNESS_MOST_SLIDING);
    for (int i = 0; i < model->n_obstacles; i++) {
        struct wb_reason why = {""};
        if (wb_obstacle_check(&model->obstacles[i], &why) != WB_OK)
            return wb_fail(WB_ERR_ARGUMENT, "obstacle %d: %s", i, why.text);
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

/* So much stiffer than an element that the gaps close in few iterations, and not so much that the
 * other forces are rounded. */
static double contact_stiffness(const struct wb_law_section *section, double length)
{
    const struct wb_law_section_stiffness k = wb_law_section_stiffness(section);
    return fmin(24.0 * k.bending / pow(length, 3.0), k.axial / length);
}

static void add_piece(struct wb_harness *h, const struct wb_harness_model *model, int branch,
                      int piece)
{
    const struct wb_harness_branch *const b = &model->branches[branch];
    struct wb_harness_chain *const own = &h->branches[branch];
    const double begin = station(b, piece - 1), length = station(b, piece) - begin;
    const int n = elements_in(length, element_length(model));
    for (int i = 0; i < n; i++) {
        const int e = own->first + own->n;
        struct wb_harness_element *const element = &h->elements[e];
        const int parent_end =
            b->parent < 0 ? 0 : h->branches[b->parent].first + h->branches[b->parent].n;
        *element = (struct wb_harness_element){
            .branch = branch,
            .near = own->n == 0 ? parent_end : e,
            .begin = begin + length * i / n,
            .section = b->section,
            .history = h->history_size,
            .row = wb_law_section_history_size(b->section),
            .radius = b->radius,
            .contact_stiffness = contact_stiffness(b->section, length / n),
        };
        wb_rod_shape_init(&element->shape, length / n);
        for (int k = 0; k < 3; k++)
            element->weight[k] = b->mass * model->gravity[k];
        h->history_size += POINTS * element->row;
        h->width[element->near] += length / n / 6.0;
        h->width[e + 1] += length / n / 6.0;
        h->width[h->n_joints + e] = 4.0 / 6.0 * length / n;
        own->n++;
    }
}

static double place_of_point(const struct wb_harness_element *element, int g)
{
    return element->begin +
           element->shape.length * (0.5 + (g % POINTS == 0 ? -0.5 : 0.5) / sqrt(3.0));
}

/* False if a natural curvature is not finite. */
static bool set_natural_shape(struct wb_harness *h, const struct wb_harness_model *model)
{
    for (int g = 0; g < h->n_points; g++) {
        const struct wb_harness_element *const element = &h->elements[g / POINTS];
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
    h->clips = wb_memory_take(&h->memory, (size_t)h->most_clips, sizeof *h->clips);
    h->width = wb_memory_take(&h->memory, (size_t)h->n_nodes, sizeof *h->width);
}

/* Of the equations beside those of the nodes. */
static void take_border_memory(struct wb_harness *h)
{
    const size_t most = WB_HARNESS_CLIP * (size_t)h->most_clips;
    if (most == 0)
        return;
    h->compliance = wb_memory_take(&h->memory, (size_t)h->n_joints, sizeof *h->compliance);
    h->equations = wb_memory_take(&h->memory, most, sizeof *h->equations);
    h->vector = wb_memory_take(&h->memory, (size_t)h->n_nodes, sizeof *h->vector);
    h->system = wb_memory_take(&h->memory, 2 * most * (most + 1), sizeof *h->system);
}

static void take_contact_memory(struct wb_harness *h)
{
    const size_t most = (size_t)h->most_contacts;
    h->obstacles = wb_memory_take(&h->memory, (size_t)h->n_obstacles, sizeof *h->obstacles);
    h->now.touch = wb_memory_take(&h->memory, most, sizeof *h->now.touch);
    h->committed_touches.touch = wb_memory_take(&h->memory, most, sizeof *h->now.touch);
    h->contacts = wb_memory_take(&h->memory, most, sizeof *h->contacts);
    h->origin = wb_memory_take(&h->memory, (size_t)h->n_points, sizeof *h->origin);
    h->first_contact = wb_memory_take(&h->memory, (size_t)h->n_joints, sizeof *h->first_contact);
}

static void take_state_memory(struct wb_harness *h)
{
    const size_t elements = (size_t)h->n_elements, points = (size_t)h->n_points;
    const size_t joints = (size_t)h->n_joints, nodes = (size_t)h->n_nodes;
    struct wb_memory *const m = &h->memory;

    h->natural = wb_memory_take(m, points, sizeof *h->natural);
    h->trial = wb_memory_take(m, points, sizeof *h->trial);
    h->committed = wb_memory_take(m, points, sizeof *h->committed);
    h->earlier = wb_memory_take(m, points, sizeof *h->earlier);
    h->history = wb_memory_take(m, h->history_size, sizeof *h->history);
    h->trial_history = wb_memory_take(m, h->history_size, sizeof *h->trial_history);
    h->yielding = wb_memory_take(m, points, sizeof *h->yielding);
    h->placed = wb_memory_take(m, NODES * elements, sizeof *h->placed);
    h->committed_nodes = wb_memory_take(m, nodes, sizeof *h->committed_nodes);
    h->motion = wb_memory_take(m, nodes, sizeof *h->motion);
    h->points = wb_memory_take(m, points, sizeof *h->points);
    h->residual = wb_memory_take(m, nodes, sizeof *h->residual);
    h->increment = wb_memory_take(m, nodes, sizeof *h->increment);
    h->diagonal = wb_memory_take(m, joints, sizeof *h->diagonal);
    h->eliminated = wb_memory_take(m, elements, sizeof *h->eliminated);
    take_border_memory(h);
    take_contact_memory(h);
}

/* --- mesh and holds --- */

int wb_harness_n_joints(const struct wb_harness *harness)
{
    return harness->n_joints;
}

int wb_harness_joint(const struct wb_harness *h, int branch, double arc_length)
{
    const struct wb_harness_chain *const b = &h->branches[branch];
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
    const struct wb_harness_element *const element = &h->elements[joint - 1];
    *arc_length = element->begin + element->shape.length;
    return element->branch;
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

const struct wb_rod_node *wb_harness_node(const struct wb_harness *harness, int joint)
{
    return wb_harness_joint_node(harness, joint);
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

void wb_harness_place_nodes(struct wb_harness *h)
{
    for (int e = 0; e < h->n_elements; e++) {
        const struct wb_harness_element *const element = &h->elements[e];
        const struct wb_harness_chain *const branch = &h->branches[element->branch];
        struct wb_rod_node *const nodes = h->placed + NODES * e;
        struct wb_rod_strain total[POINTS];
        nodes[0] = *wb_harness_joint_node(h, element->near);
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
    h->n_nodes = h->n_joints + h->n_elements;
    h->most_clips = model->most_sliding;
    h->n_obstacles = model->n_obstacles;
    h->most_contacts = h->n_obstacles > 0 ? WB_HARNESS_PLACES * h->n_elements : 0;
    h->n_points = POINTS * h->n_elements;
    h->lever = 1.0 / element_length(model);
    memcpy(h->gravity, model->gravity, sizeof h->gravity);
    take_mesh_memory(h);
    for (int i = 0, first = 0; i < h->n_branches; i++) {
        const struct wb_harness_branch *const b = &model->branches[i];
        struct wb_harness_chain *const own = &h->branches[i];
        *own = (struct wb_harness_chain){.length = b->length, .first = first};
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
    for (int i = 0; i < h->n_obstacles; i++)
        h->obstacles[i] = model->obstacles[i];
    if (!set_natural_shape(h, model)) {
        wb_harness_destroy(h);
        return wb_fail(WB_ERR_ARGUMENT, "a natural curvature is not finite");
    }
    wb_harness_contact_revert(h);
    h->joints[0].hold = WB_HARNESS_FIXED;
    h->joints[0].target = h->root = h->committed_root = h->earlier_root = model->root;
    wb_harness_place_nodes(h);
    for (int i = 0; i < h->n_nodes; i++)
        h->committed_nodes[i] = *wb_harness_any_node(h, i);
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

/* --- motions --- */

int wb_harness_body_arm(const struct wb_harness *h, const struct wb_harness_body *body,
                        double arm[3], double force[3])
{
    const struct wb_harness_chain *const b = &h->branches[body->branch];
    const int joint = b->first + b->n;
    double R[9];
    wb_rod_element_matrix(wb_harness_joint_node(h, joint)->rotation, R);
    for (int i = 0; i < 3; i++) {
        arm[i] = wb_vec3_dot(R + 3 * i, body->centre);
        force[i] = body->mass * h->gravity[i];
    }
    return joint;
}

void wb_harness_motion(const struct wb_rod_node *was, const struct wb_rod_node *now,
                       double motion[U])
{
    for (int k = 0; k < 3; k++)
        motion[k] = now->position[k] - was->position[k];
    wb_rod_element_turn_between(was->rotation, now->rotation, motion + 3);
}

void wb_harness_turn_root(struct wb_harness *h, const double spin[3])
{
    double q[4];
    wb_rod_element_exponential(spin, q);
    wb_rod_element_compose(q, h->root.rotation, h->root.rotation);
}

/* --- history --- */

static void remember_nodes(struct wb_harness *h)
{
    for (int i = 0; i < h->n_nodes; i++) {
        wb_harness_motion(&h->committed_nodes[i], wb_harness_any_node(h, i), h->motion[i]);
        h->committed_nodes[i] = *wb_harness_any_node(h, i);
    }
}

void wb_harness_revert(struct wb_harness *h)
{
    copy_strains(h, h->trial, h->committed);
    for (int i = 0; i < h->n_clips; i++)
        h->clips[i].now = h->clips[i].committed;
    wb_harness_contact_revert(h);
    h->root = h->committed_root;
    wb_harness_place_nodes(h);
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
    for (int i = 0; i < h->n_clips; i++) {
        const struct wb_harness_sliding *const is = &h->clips[i].committed;
        const struct wb_harness_sliding *const was = &h->clips[i].earlier;
        h->clips[i].now = *is;
        if (!is->is_at_end)
            h->clips[i].now.s += ratio * (is->s - was->s);
        for (int k = 0; k < 3; k++)
            h->clips[i].now.force[k] += ratio * (is->force[k] - was->force[k]);
    }
    wb_harness_contact_revert(h);
    double spin[3];
    h->root = h->committed_root;
    wb_rod_element_turn_between(h->earlier_root.rotation, h->committed_root.rotation, spin);
    for (int k = 0; k < 3; k++) {
        h->root.position[k] +=
            ratio * (h->committed_root.position[k] - h->earlier_root.position[k]);
        spin[k] *= ratio;
    }
    wb_harness_turn_root(h, spin);
    wb_harness_place_nodes(h);
}

/* The plastic work of the step, by the trapezoidal rule. */
static void add_plastic_work(struct wb_harness *h)
{
    for (int g = 0; g < h->n_points; g++) {
        const struct wb_harness_element *const element = &h->elements[g / POINTS];
        const struct wb_law_section_stiffness k = wb_law_section_stiffness(element->section);
        const double stiffness[3] = {k.axial, k.bending, k.bending};
        const double *const f = h->points[g].section.force;
        const double force[3] = {f[0], f[2], f[3]};
        const struct wb_rod_strain *const at = &h->trial[g];
        const double strain[3] = {at->stretch[0], at->curvature[1], at->curvature[2]};
        struct wb_harness_yielding *const y = &h->yielding[g];
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
    for (int i = 0; i < h->n_clips; i++) {
        h->clips[i].now.slip = wb_harness_clip_slip(h, &h->clips[i]);
        h->clips[i].earlier = h->clips[i].committed;
        h->clips[i].committed = h->clips[i].now;
    }
    wb_harness_contact_commit(h);
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
    const size_t joints = (size_t)h->n_joints, nodes = (size_t)h->n_nodes;
    const struct part list[] = {
        {h->joints, joints * sizeof *h->joints},
        {&h->n_clips, sizeof h->n_clips},
        {h->clips, (size_t)h->most_clips * sizeof *h->clips},
        {&h->now.n, sizeof h->now.n},
        {&h->contact_factor, sizeof h->contact_factor},
        {h->now.touch, (size_t)h->most_contacts * sizeof *h->now.touch},
        {&h->committed_touches.n, sizeof h->now.n},
        {h->committed_touches.touch, (size_t)h->most_contacts * sizeof *h->now.touch},
        {&h->drag, sizeof h->drag},
        {&h->carried, sizeof h->carried},
        {&h->weight, sizeof h->weight},
        {&h->largest_force, sizeof h->largest_force},
        {h->trial, points * sizeof *h->trial},
        {h->committed, points * sizeof *h->committed},
        {h->earlier, points * sizeof *h->earlier},
        {&h->root, sizeof h->root},
        {&h->committed_root, sizeof h->committed_root},
        {&h->earlier_root, sizeof h->earlier_root},
        {h->yielding, points * sizeof *h->yielding},
        {&h->plastic_work, sizeof h->plastic_work},
        {h->history, h->history_size * sizeof *h->history},
        {h->placed, NODES * elements * sizeof *h->placed},
        {h->committed_nodes, nodes * sizeof *h->committed_nodes},
        {h->motion, nodes * sizeof *h->motion},
        {h->points, points * sizeof *h->points},
        {h->residual, nodes * sizeof *h->residual},
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
    wb_harness_contact_find(harness);
}

double wb_harness_turn(const struct wb_harness *h)
{
    double least = 1.0;
    for (int j = 0; j < h->n_joints; j++) {
        const double *const a = h->committed_nodes[j].rotation, *const b =
                                                                    wb_harness_joint_node(h, j)
                                                                        ->rotation;
        least = fmin(least, fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]));
    }
    return 2.0 * acos(least);
}

/* --- results --- */

int wb_harness_element_at(const struct wb_harness *h, int branch, double arc_length)
{
    const struct wb_harness_chain *const b = &h->branches[branch];
    int e = b->first;
    while (e + 1 < b->first + b->n && h->elements[e + 1].begin <= arc_length)
        e++;
    return e;
}

struct wb_rod_node wb_harness_position(const struct wb_harness *h, int branch, double arc_length)
{
    const double s = fmin(fmax(arc_length, 0.0), h->branches[branch].length);
    const int e = wb_harness_element_at(h, branch, s);
    const struct wb_harness_element *const element = &h->elements[e];
    const struct wb_rod_node *const node = h->placed + NODES * e;
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

void wb_harness_weight(const struct wb_harness *h, double weight[6])
{
    static const double parts[NODES] = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
    memset(weight, 0, U * sizeof *weight);
    for (int e = 0; e < h->n_elements; e++) {
        for (int i = 0; i < NODES; i++) {
            double force[3];
            for (int k = 0; k < 3; k++)
                force[k] = parts[i] * h->elements[e].shape.length * h->elements[e].weight[k];
            wb_harness_add_force(weight, force, h->placed[NODES * e + i].position);
        }
    }
    for (int i = 0; i < h->n_bodies; i++) {
        double arm[3], force[3];
        const int joint = wb_harness_body_arm(h, &h->bodies[i], arm, force);
        for (int k = 0; k < 3; k++)
            arm[k] += wb_harness_joint_node(h, joint)->position[k];
        wb_harness_add_force(weight, force, arm);
    }
}

int wb_harness_n_points(const struct wb_harness *harness)
{
    return harness->n_points;
}

void wb_harness_point(const struct wb_harness *h, int index, struct wb_harness_point *point)
{
    const struct wb_harness_element *const element = &h->elements[index / POINTS];
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
        const struct wb_harness_element *const element = &h->elements[g / POINTS];
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
        const struct wb_harness_element *const element = &h->elements[e];
        const double EI = wb_law_section_stiffness(element->section).bending;
        *stiffest = fmax(*stiffest, EI / pow(element->shape.length, 4.0));
        *softest = fmin(*softest, EI / pow(h->length, 4.0));
    }
}

double wb_harness_noise(const struct wb_harness *h)
{
    double widest = 0.0;
    for (int e = 0; e < h->n_elements && h->drag > 0.0; e++)
        widest = fmax(widest, h->width[h->n_joints + e]);
    double touched = 0.0;
    for (int i = 0; i < h->n_contacts; i++)
        touched = fmax(touched, h->elements[h->contacts[i].touch.element].contact_stiffness);
    /* Positions are rounded. */
    return h->noise +
           DBL_EPSILON * h->length * (4.0 * h->drag * widest + h->contact_factor * touched);
}
