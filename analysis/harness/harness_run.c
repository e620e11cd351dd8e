#include "analysis/harness/harness_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/harness/harness_frames.h"
#include "base/memory.h"
#include "base/units.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "harness"

/* A wire may begin as deep in an obstacle, over its diameter. */
static const double most_depth = 5e-3;

/* What is saved beside the solver's state. */
struct own_state {
    double weight;                                    /* factor on the weight */
    double largest_bending[WB_HARNESS_MOST_BRANCHES]; /* from the first step on */
};

struct wb_harness_run {
    const struct wb_harness_plan *plan;
    struct wb_harness_settings settings;
    struct wb_law_section *sections[WB_HARNESS_MOST_WIRES];
    struct wb_harness *harness;
    struct wb_harness_solver *solver;
    int joints[WB_HARNESS_MOST_ITEMS];
    int begins[WB_HARNESS_MOST_BRANCHES]; /* first place of each branch */
    int n_places;
    struct own_state own;
    void *before; /* state before a release */
    /* Of the current step. */
    struct wb_harness_step_result *result;
    struct wb_harness_frames frames; /* none outside wb_harness_run_compute() */
    bool (*watch)(void *context, double fraction);
    void *context;
};

/* --- the model --- */

double wb_harness_run_torsion(const struct wb_harness_plan *plan, int wire,
                              const struct wb_harness_settings *settings)
{
    const struct wb_harness_wire *const w = &plan->wires[wire];
    const double EI = w->law.material.youngs_modulus * M_PI * pow(w->diameter, 4.0) / 64.0;
    return w->torsional_stiffness > 0.0
               ? w->torsional_stiffness
               : settings->torsion * EI / (1.0 + w->law.material.poissons_ratio);
}

static enum wb_status make_section(struct wb_harness_run *run, int i)
{
    const struct wb_harness_wire *const wire = &run->plan->wires[i];
    const struct wb_law_part part = {wire->law.material.youngs_modulus, (double)INFINITY};
    struct wb_law law = wire->law;
    if (run->settings.is_elastic)
        wb_law_init_parallel(&law, &part, 1, 0.0, wire->law.material.poissons_ratio);
    const struct wb_law_section_model model = {
        .diameter = wire->diameter,
        .law = &law,
        .torsional_stiffness = wb_harness_run_torsion(run->plan, i, &run->settings),
        .fibres = run->settings.fibres,
    };
    return wb_law_section_create(&run->sections[i], &model);
}

/* Curvature between the places of a natural shape, constant beyond the first and the last. */
static void natural_curvature(void *context, double s, double curvature[3])
{
    const struct wb_harness_plan_branch *const b = context;
    const int last = b->n_curve - 1;
    int i = 0;
    while (i < last && b->place[i + 1] <= s)
        i++;
    const double span = i < last ? b->place[i + 1] - b->place[i] : 0.0;
    const double part = span > 0.0 ? fmax((s - b->place[i]) / span, 0.0) : 0.0;
    for (int k = 0; k < 2; k++) {
        const double next = b->curvature[i < last ? i + 1 : i][k];
        curvature[1 + k] = b->curvature[i][k] + part * (next - b->curvature[i][k]);
    }
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Places of the clips within a branch, ascending; returns their number. */
static int find_stations(const struct wb_harness_plan *plan, int branch, double *stations)
{
    int n = 0;
    for (int i = 1; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        if (item->branch == branch && item->at < plan->branches[branch].length)
            stations[n++] = item->at;
    }
    qsort(stations, (size_t)n, sizeof *stations, by_value);
    return n;
}

static int count_sliding(const struct wb_harness_plan *plan)
{
    int n = 0;
    for (int i = 0; i < plan->n_items; i++)
        n += plan->items[i].hold == WB_HARNESS_SLIDE;
    return n;
}

/* The obstacles must not be where the wires are at first. */
static enum wb_status check_obstacles(const struct wb_harness_run *run)
{
    const struct wb_harness_plan *const plan = run->plan;
    int obstacle, branch;
    double at;
    const double depth = wb_harness_depth(run->harness, &obstacle, &branch, &at);
    if (!(depth > 0.0) || depth < most_depth * plan->wires[plan->branches[branch].wire].diameter)
        return WB_OK;
    return wb_fail(WB_ERR_ARGUMENT,
                   "%s: obstacles: branch %s is %.3g mm deep in %s at %.4g mm before the first "
                   "step, free of stress; move the obstacle, or turn the branch",
                   plan->path, plan->branches[branch].name, depth / WB_MM,
                   plan->obstacles[obstacle].name, at / WB_MM);
}

static enum wb_status make_harness(struct wb_harness_run *run)
{
    const struct wb_harness_plan *const plan = run->plan;
    const size_t n = (size_t)plan->n_branches;
    struct wb_memory memory = {0};
    struct wb_harness_branch *const branches = wb_memory_take(&memory, n, sizeof *branches);
    struct wb_harness_body *const bodies =
        wb_memory_take(&memory, (size_t)plan->n_items, sizeof *bodies);
    struct wb_obstacle *const obstacles =
        wb_memory_take(&memory, (size_t)plan->n_obstacles, sizeof *obstacles);
    for (int i = 0; i < plan->n_obstacles; i++)
        obstacles[i] = plan->obstacles[i].body;
    struct wb_harness_model model = {
        .n_branches = plan->n_branches,
        .branches = branches,
        .bodies = bodies,
        .element_length = run->settings.element_length,
        .most_sliding = count_sliding(plan),
        .n_obstacles = plan->n_obstacles,
        .obstacles = obstacles,
        .root = plan->root,
    };
    memcpy(model.gravity, plan->gravity, sizeof model.gravity);
    for (int i = 0; i < plan->n_branches; i++) {
        const struct wb_harness_plan_branch *const b = &plan->branches[i];
        double *const stations = wb_memory_take(&memory, (size_t)plan->n_items, sizeof *stations);
        branches[i] = (struct wb_harness_branch){
            .parent = b->parent,
            .section = run->sections[b->wire],
            .length = b->length,
            .mass = plan->wires[b->wire].mass,
            .radius = 0.5 * plan->wires[b->wire].diameter,
            .natural_curvature = b->n_curve > 0 ? natural_curvature : NULL,
            .curvature_context = (void *)b,
            .n_stations = find_stations(plan, i, stations),
            .stations = stations,
        };
        memcpy(branches[i].leaving, b->leaving, sizeof b->leaving);
    }
    for (int i = 1; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        if (item->kind != WB_HARNESS_CONNECTOR || item->mass == 0.0)
            continue;
        struct wb_harness_body *const body = &bodies[model.n_bodies++];
        *body = (struct wb_harness_body){.branch = item->branch, .mass = item->mass};
        memcpy(body->centre, item->centre, sizeof body->centre);
    }
    enum wb_status status = wb_harness_create(&run->harness, &model);
    wb_memory_release(&memory);
    if (status == WB_OK)
        status = check_obstacles(run);
    if (status != WB_OK)
        return status;
    for (int i = 0; i < plan->n_items; i++)
        run->joints[i] =
            plan->items[i].branch < 0
                ? 0
                : wb_harness_joint(run->harness, plan->items[i].branch, plan->items[i].at);
    const struct wb_harness_solver_model solver = {.harness = run->harness,
                                                   .most_rotation = run->settings.most_rotation};
    return wb_harness_solver_create(&run->solver, &solver);
}

/* --- results --- */

/* Two places an element, its points, and those of the branch's beginning and end. */
static void plan_places(struct wb_harness_run *run)
{
    const int n_points = wb_harness_n_points(run->harness);
    run->n_places = n_points + 2 * run->plan->n_branches;
    for (int i = 0, next = 0, g = 0; i < run->plan->n_branches; i++) {
        struct wb_harness_point point;
        run->begins[i] = next++;
        for (; g < n_points; g++, next++) {
            wb_harness_point(run->harness, g, &point);
            if (point.branch != i)
                break;
        }
        next++;
    }
}

static void set_place(const struct wb_harness_run *run, struct wb_harness_place *place, int branch,
                      double s)
{
    const struct wb_rod_node node = wb_harness_position(run->harness, branch, s);
    double R[9];
    wb_rod_element_matrix(node.rotation, R);
    *place = (struct wb_harness_place){.branch = branch, .s = s};
    for (int k = 0; k < 3; k++) {
        place->position[k] = node.position[k];
        place->direction[k] = R[3 * k];
        place->up[k] = R[3 * k + 2];
    }
}

/* The curve's values at an end of a branch are those of its nearest point. */
static void take_places(const struct wb_harness_run *run, struct wb_harness_place *places)
{
    const int n_points = wb_harness_n_points(run->harness);
    int next[WB_HARNESS_MOST_BRANCHES];
    for (int i = 0; i < run->plan->n_branches; i++)
        next[i] = run->begins[i] + 1;
    for (int g = 0; g < n_points; g++) {
        struct wb_harness_point point;
        wb_harness_point(run->harness, g, &point);
        struct wb_harness_place *const place = &places[next[point.branch]++];
        set_place(run, place, point.branch, point.arc_length);
        place->curvature = hypot(point.curvature[1], point.curvature[2]);
        place->twist = point.curvature[0];
        place->moment = hypot(point.moment[1], point.moment[2]);
        place->torque = point.moment[0];
        place->tension = point.force;
    }
    for (int i = 0; i < run->plan->n_branches; i++) {
        struct wb_harness_place *const first = &places[run->begins[i]];
        struct wb_harness_place *const last = &places[next[i]];
        struct wb_harness_place end;
        *first = first[1];
        *last = last[-1];
        for (int at = 0; at < 2; at++) {
            struct wb_harness_place *const to = at == 0 ? first : last;
            set_place(run, &end, i, at == 0 ? 0.0 : run->plan->branches[i].length);
            to->s = end.s;
            memcpy(to->position, end.position, sizeof end.position);
            memcpy(to->direction, end.direction, sizeof end.direction);
            memcpy(to->up, end.up, sizeof end.up);
        }
    }
}

static bool is_held(const struct wb_harness_run *run, int item)
{
    return wb_harness_hold(run->harness, run->joints[item]) != WB_HARNESS_FREE;
}

/* Force of an obstacle on the wires, N, and its moment about its place, in space. */
static void find_obstacle_force(const struct wb_harness_run *run, int i, double force[6])
{
    double moment[3];
    wb_harness_obstacle_force(run->harness, i, force);
    wb_vec3_cross(run->plan->obstacles[i].body.place, force, moment);
    for (int k = 0; k < 3; k++)
        force[3 + k] -= moment[k];
}

static void take_obstacle_force(const struct wb_harness_run *run, int i, struct wb_harness_force *f)
{
    double R[9], force[6];
    find_obstacle_force(run, i, force);
    wb_rod_element_matrix(run->plan->obstacles[i].body.rotation, R);
    wb_vec3_turn_back(R, force, f->force);
    wb_vec3_turn_back(R, force + 3, f->moment);
    f->size = wb_vec3_length(f->force);
    f->moment_size = wb_vec3_length(f->moment);
    f->is_mounted = f->size > 0.0 || f->largest > 0.0;
    f->slid = f->soft_force = (double)NAN;
}

/* Those of the current state; `largest` and limits stay. */
static void take_forces(const struct wb_harness_run *run, struct wb_harness_force *forces)
{
    for (int i = 0; i < run->plan->n_items; i++) {
        struct wb_harness_force *const f = &forces[i];
        double R[9], reaction[6];
        f->is_mounted = is_held(run, i);
        if (!f->is_mounted)
            continue;
        wb_harness_reaction(run->harness, run->joints[i], reaction);
        wb_rod_element_matrix(wb_harness_held_node(run->harness, run->joints[i]).rotation, R);
        for (int k = 0; k < 3; k++) {
            const double axis[3] = {R[k], R[3 + k], R[6 + k]};
            f->force[k] = wb_vec3_dot(axis, reaction);
            f->moment[k] = wb_vec3_dot(axis, reaction + 3);
        }
        f->size = wb_vec3_length(f->force);
        f->moment_size = wb_vec3_length(f->moment);
        f->slid = run->plan->items[i].hold == WB_HARNESS_SLIDE
                      ? wb_harness_slid(run->harness, run->joints[i])
                      : (double)NAN;
        f->soft_force = (double)NAN;
    }
    for (int i = 0; i < run->plan->n_obstacles; i++)
        take_obstacle_force(run, i, &forces[run->plan->n_items + i]);
}

/* Bend radii and curvatures of the current state. */
static void watch_branches(struct wb_harness_run *run, bool at_end)
{
    for (int g = 0; g < wb_harness_n_points(run->harness); g++) {
        struct wb_harness_point point;
        wb_harness_point(run->harness, g, &point);
        struct wb_harness_branch_result *const b = &run->result->branches[point.branch];
        const struct wb_harness_plan_branch *const plan = &run->plan->branches[point.branch];
        const double bending = hypot(point.bending[1], point.bending[2]);
        const double radius = 1.0 / hypot(point.curvature[1], point.curvature[2]);
        double *const so_far = &run->own.largest_bending[point.branch];
        *so_far = b->largest_bending_so_far = fmax(*so_far, bending);
        b->is_beyond = b->largest_bending_so_far > run->plan->wires[plan->wire].largest_curvature;
        b->tightest_radius = fmin(b->tightest_radius, radius);
        b->exceeds_radius |= radius < plan->least_radius;
        if (!at_end)
            continue;
        b->largest_bending = fmax(b->largest_bending, bending);
        if (radius < b->least_radius) {
            b->least_radius = radius;
            b->at = point.arc_length;
        }
    }
}

static bool observe(void *context, double fraction)
{
    struct wb_harness_run *const run = context;
    for (int i = 0; i < run->plan->n_items; i++) {
        const struct wb_harness_item *const item = &run->plan->items[i];
        struct wb_harness_force *const f = &run->result->forces[i];
        double reaction[6];
        if (!is_held(run, i))
            continue;
        wb_harness_reaction(run->harness, run->joints[i], reaction);
        f->largest = fmax(f->largest, wb_vec3_length(reaction));
        f->largest_moment = fmax(f->largest_moment, wb_vec3_length(reaction + 3));
        f->exceeds_force = item->largest_force > 0.0 && f->largest > item->largest_force;
        f->exceeds_moment = item->largest_moment > 0.0 && f->largest_moment > item->largest_moment;
    }
    for (int i = 0; i < run->plan->n_obstacles; i++) {
        struct wb_harness_force *const f = &run->result->forces[run->plan->n_items + i];
        double force[6];
        find_obstacle_force(run, i, force);
        f->largest = fmax(f->largest, wb_vec3_length(force));
        f->largest_moment = fmax(f->largest_moment, wb_vec3_length(force + 3));
    }
    watch_branches(run, false);
    struct wb_harness_frame *const frame = wb_harness_frames_take(&run->frames, fraction);
    if (frame) {
        memcpy(frame->forces, run->result->forces,
               (size_t)run->frames.n_forces * sizeof *frame->forces);
        take_forces(run, frame->forces);
        take_places(run, frame->places);
    }
    return !run->watch || run->watch(run->context, fraction);
}

/* --- steps --- */

static void move(struct wb_harness_run *run, const struct wb_harness_step *step,
                 struct wb_harness_result *result)
{
    const int joint = run->joints[step->item];
    const struct wb_harness_item *const item = &run->plan->items[step->item];
    const struct wb_rod_node now = wb_harness_held_node(run->harness, joint);
    struct wb_harness_aim aim = {.joint = joint, .target = now};
    if (step->kind == WB_HARNESS_MOUNT && item->hold == WB_HARNESS_SLIDE)
        wb_harness_let_slide(run->harness, joint, item->friction);
    else if (step->kind == WB_HARNESS_MOUNT)
        wb_harness_set_hold(run->harness, joint, item->hold, &now);
    memcpy(aim.target.position, step->position, sizeof step->position);
    if (step->has_direction)
        wb_harness_file_rotation(step->direction, step->has_up ? step->up : NULL, now.rotation,
                                 aim.target.rotation);
    const struct wb_harness_move m = {
        .n_aims = 1, .aims = &aim, .weight = run->own.weight, .observer = observe, .context = run};
    wb_harness_solver_move(run->solver, &m, result);
}

/* Lets go of what a step names. Without an equilibrium it stays held. */
static void let_go(struct wb_harness_run *run, const struct wb_harness_step *step,
                   struct wb_harness_result *result)
{
    wb_harness_run_save(run, run->before);
    if (step->kind == WB_HARNESS_RELEASE) {
        wb_harness_set_hold(run->harness, run->joints[step->item], WB_HARNESS_FREE, NULL);
    } else {
        for (int i = 1; i < run->plan->n_items; i++)
            wb_harness_set_hold(run->harness, run->joints[i], WB_HARNESS_FREE, NULL);
        wb_harness_set_hold(run->harness, 0, WB_HARNESS_FIXED, wb_harness_node(run->harness, 0));
        run->own.weight = 0.0;
    }
    wb_harness_solver_settle(run->solver, run->own.weight, observe, run, result);
    if (result->end != WB_HARNESS_CONVERGED)
        wb_harness_run_restore(run, run->before);
}

static void compute_step(struct wb_harness_run *run, const struct wb_harness_step *step,
                         struct wb_harness_result *result)
{
    const struct wb_harness_move hang = {.weight = 1.0, .observer = observe, .context = run};
    switch (step->kind) {
    case WB_HARNESS_HANG:
        run->own.weight = 1.0;
        wb_harness_solver_move(run->solver, &hang, result);
        break;
    case WB_HARNESS_MOUNT:
    case WB_HARNESS_MOVE:
        move(run, step, result);
        break;
    case WB_HARNESS_RELEASE:
    case WB_HARNESS_TAKE_OFF:
        let_go(run, step, result);
        break;
    }
}

static void take_step(struct wb_harness_run *run, const struct wb_harness_result *result)
{
    struct wb_harness_step_result *const r = run->result;
    double s;
    r->end = result->end;
    r->problem = result->problem;
    r->fraction = result->fraction;
    r->worst_branch = result->end == WB_HARNESS_NOT_CONVERGED
                          ? wb_harness_place_of(run->harness, result->worst_joint, &s)
                          : -1;
    r->increments = result->increments;
    r->iterations = result->iterations;
    r->n_snaps = result->n_snaps;
    memcpy(r->snaps, result->snaps, sizeof r->snaps);
    for (int i = 0; i < r->n_snaps; i++)
        r->snap_branch[i] = wb_harness_place_of(run->harness, r->snaps[i].joint, &r->snap_at[i]);
    r->elastic = wb_harness_elastic_energy(run->harness);
    r->plastic = wb_harness_plastic_work(run->harness);
    take_forces(run, r->forces);
    watch_branches(run, true);
    take_places(run, r->places);
}

void wb_harness_run_take_memory(const struct wb_harness_run *run, struct wb_memory *memory,
                                struct wb_harness_step_result *result)
{
    const size_t branches = (size_t)run->plan->n_branches;
    result->forces = wb_memory_take(memory, (size_t)wb_harness_file_n_holders(run->plan),
                                    sizeof *result->forces);
    result->branches = wb_memory_take(memory, branches, sizeof *result->branches);
    result->places = wb_memory_take(memory, (size_t)run->n_places, sizeof *result->places);
}

static void begin_result(struct wb_harness_run *run, struct wb_harness_step_result *result)
{
    run->result = result;
    memset(result->forces, 0,
           (size_t)wb_harness_file_n_holders(run->plan) * sizeof *result->forces);
    for (int i = 0; i < run->plan->n_branches; i++)
        result->branches[i] = (struct wb_harness_branch_result){
            .least_radius = (double)INFINITY,
            .tightest_radius = (double)INFINITY,
            .largest_bending_so_far = run->own.largest_bending[i],
        };
}

void wb_harness_run_step(struct wb_harness_run *run, const struct wb_harness_step *step,
                         bool (*watch)(void *context, double fraction), void *context,
                         struct wb_harness_step_result *result)
{
    struct wb_harness_result computed;
    run->watch = watch;
    run->context = context;
    begin_result(run, result);
    compute_step(run, step, &computed);
    take_step(run, &computed);
}

void wb_harness_run_begin(struct wb_harness_run *run, struct wb_harness_step_result *result)
{
    const struct wb_harness_result none = {.end = WB_HARNESS_CONVERGED, .fraction = 1.0};
    begin_result(run, result);
    take_step(run, &none);
}

/* --- the state --- */

size_t wb_harness_run_state_size(const struct wb_harness_run *run)
{
    return sizeof run->own + wb_harness_solver_state_size(run->solver);
}

void wb_harness_run_save(const struct wb_harness_run *run, void *state)
{
    memcpy(state, &run->own, sizeof run->own);
    wb_harness_solver_save(run->solver, (char *)state + sizeof run->own);
}

void wb_harness_run_restore(struct wb_harness_run *run, const void *state)
{
    memcpy(&run->own, state, sizeof run->own);
    wb_harness_solver_restore(run->solver, (const char *)state + sizeof run->own);
}

struct wb_rod_node wb_harness_run_item(const struct wb_harness_run *run, int item)
{
    return wb_harness_held_node(run->harness, run->joints[item]);
}

int wb_harness_run_n_places(const struct wb_harness_run *run)
{
    return run->n_places;
}

static enum wb_status create(struct wb_harness_run *run)
{
    struct wb_harness_balance balance;
    for (int i = 0; i < run->plan->n_wires; i++)
        WB_TRY(make_section(run, i));
    WB_TRY(make_harness(run));
    plan_places(run);
    wb_harness_evaluate(run->harness, 0.0, &balance);
    run->before = wb_memory_new(wb_harness_run_state_size(run), 1);
    return WB_OK;
}

enum wb_status wb_harness_run_create(struct wb_harness_run **out,
                                     const struct wb_harness_plan *plan,
                                     const struct wb_harness_settings *settings)
{
    struct wb_harness_run *const run = wb_memory_new(1, sizeof *run);
    run->plan = plan;
    run->settings = *settings;
    const enum wb_status status = create(run);
    if (status == WB_OK)
        *out = run;
    else
        wb_harness_run_destroy(run);
    return status;
}

void wb_harness_run_destroy(struct wb_harness_run *run)
{
    if (!run)
        return;
    wb_harness_solver_destroy(run->solver);
    wb_harness_destroy(run->harness);
    for (int i = 0; i < run->plan->n_wires; i++)
        wb_law_section_destroy(run->sections[i]);
    free(run->before);
    free(run);
}

/* --- all steps of the file --- */

struct watched {
    int step;
    bool (*progress)(void *context, int step, double fraction);
    void *context;
};

static bool watch_step(void *context, double fraction)
{
    const struct watched *const watched = context;
    return !watched->progress || watched->progress(watched->context, watched->step, fraction);
}

static void add_shape(struct wb_harness_result_set *set, int step, double fraction,
                      const struct wb_harness_place *places, const struct wb_harness_force *forces)
{
    set->shapes[set->n_shapes++] = (struct wb_harness_shape){
        .time = round((step + fraction) * 1e6) / 1e6,
        .step = step,
        .places = places,
        .forces = forces,
    };
}

static void add_shapes(struct wb_harness_result_set *set, struct wb_harness_frames *frames,
                       int step, const struct wb_harness_step_result *result)
{
    wb_harness_frames_end(frames, result->fraction);
    for (int i = 0; i < frames->n; i++)
        add_shape(set, step, frames->list[i].fraction, frames->list[i].places,
                  frames->list[i].forces);
    add_shape(set, step, 1.0, result->places, result->forces);
}

static void compute(struct wb_harness_result_set *set, struct wb_harness_run *run,
                    struct watched *watched)
{
    const struct wb_harness_plan *const plan = set->plan;
    const size_t most_shapes = 1 + (size_t)plan->n_steps * (1 + (size_t)set->settings.frames);
    struct wb_harness_step_result natural;
    struct wb_harness_frames *const frames = &run->frames;
    double weight[6];
    wb_harness_run_take_memory(run, set->memory, &natural);
    wb_harness_run_begin(run, &natural);
    wb_harness_weight(run->harness, weight);
    set->n_elements = wb_harness_n_points(run->harness) / 2;
    set->n_places = run->n_places;
    set->weight = wb_vec3_length(weight);
    set->natural = natural.places;
    set->results = wb_memory_take(set->memory, (size_t)plan->n_steps, sizeof *set->results);
    set->shapes = wb_memory_take(set->memory, most_shapes, sizeof *set->shapes);
    add_shape(set, -1, 1.0, set->natural, natural.forces);
    *frames = (struct wb_harness_frames){.n_wanted = set->settings.frames,
                                         .n_places = set->n_places,
                                         .n_forces = wb_harness_file_n_holders(plan),
                                         .memory = set->memory};
    wb_harness_frames_create(frames);
    set->converged = true;
    for (int i = 0; i < plan->n_steps && set->converged; i++) {
        struct wb_harness_step_result *const result = &set->results[i];
        const enum wb_harness_step_kind kind = plan->steps[i].kind;
        watched->step = i;
        wb_harness_run_take_memory(run, set->memory, result);
        wb_harness_frames_begin(frames, kind == WB_HARNESS_RELEASE || kind == WB_HARNESS_TAKE_OFF);
        wb_harness_run_step(run, &plan->steps[i], watch_step, watched, result);
        add_shapes(set, frames, i, result);
        set->n_steps = i + 1;
        set->converged = result->end == WB_HARNESS_CONVERGED;
    }
}

double wb_harness_run_place(const struct wb_harness_plan *plan,
                            const struct wb_harness_force *forces, int item)
{
    const double slid = forces ? forces[item].slid : 0.0;
    return plan->items[item].at + (isfinite(slid) ? slid : 0.0);
}

static bool has_default_torsion(const struct wb_harness_plan *plan)
{
    for (int i = 0; i < plan->n_branches; i++) {
        if (plan->wires[plan->branches[i].wire].torsional_stiffness == 0.0)
            return true;
    }
    return false;
}

static enum wb_status compute_once(struct wb_harness_result_set *set,
                                   const struct wb_harness_plan *plan,
                                   const struct wb_harness_settings *settings,
                                   bool (*progress)(void *context, int step, double fraction),
                                   void *context)
{
    struct wb_harness_run *run;
    struct watched watched = {.progress = progress, .context = context};
    *set = (struct wb_harness_result_set){.plan = plan, .settings = *settings};
    set->memory = wb_memory_new(1, sizeof *set->memory);
    WB_TRY(wb_harness_run_create(&run, plan, settings));
    compute(set, run, &watched);
    wb_harness_run_destroy(run);
    return WB_OK;
}

enum wb_status wb_harness_run_compute(struct wb_harness_result_set *set,
                                      const struct wb_harness_plan *plan,
                                      const struct wb_harness_settings *settings,
                                      bool (*progress)(void *context, int step, double fraction),
                                      void *context)
{
    struct wb_harness_result_set soft;
    struct wb_harness_settings softer = *settings;
    WB_TRY(compute_once(set, plan, settings, progress, context));
    if (!has_default_torsion(plan) || !set->converged)
        return WB_OK;
    softer.torsion *= 0.2;
    softer.frames = 0;
    const enum wb_status status = compute_once(&soft, plan, &softer, progress, context);
    for (int i = 0; status == WB_OK && i < soft.n_steps && soft.converged; i++) {
        for (int k = 0; k < wb_harness_file_n_holders(plan); k++)
            set->results[i].forces[k].soft_force = soft.results[i].forces[k].size;
    }
    wb_harness_run_release(&soft);
    return status;
}

void wb_harness_run_release(struct wb_harness_result_set *set)
{
    if (set->memory)
        wb_memory_release(set->memory);
    free(set->memory);
    *set = (struct wb_harness_result_set){.plan = NULL};
}
