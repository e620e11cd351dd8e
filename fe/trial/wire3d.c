#include "fe/trial/wire3d.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interpolate.h"
#include "base/memory.h"
#include "fe/solid/solid.h"

/* Arc-length increment past a limit point, relative to the wire's length, and maximum number of
 * increments. */
static const double arc_share = 0.02;

enum {
    MAX_ARC_INCREMENTS = 100
};

/* Small sliding is valid up to this fraction of an element's shorter side on the interface. */
static const double slip_share = 0.25;

struct wb_wire3d {
    const struct wb_wire_model *model; /* borrowed */
    struct wb_solid_mesh mesh;
    struct wb_solid *solid;
    double sliding; /* largest sliding of the run, over the interface, m */
    bool has_run;
};

/* A run in progress. */
struct run {
    struct wb_wire3d *wire;
    struct wb_wire_progress at;
    bool slack;  /* the strand carries no force */
    double held; /* deflection at which the strand would become taut, m */
};

static enum wb_status make_mesh(struct wb_wire3d *wire)
{
    const struct wb_wire_model *m = wire->model;
    struct wb_solid_mesh_wire shape = {
        .length = m->length,
        .n_parts = m->n_parts,
        .elements_along = m->elements_along,
        .section_density = m->section_density,
        .split = m->has_contact,
    };

    for (int p = 0; p < m->n_parts; p++)
        shape.outer_diameter[p] = m->part[p].outer_diameter;
    return wb_solid_mesh_sweep(&wire->mesh, &shape);
}

/* A plane clamp holds the section's plane; nodes on the section's axes hold its centre and
 * rotation, so that the section can contract freely. */
static int hold_clamp(const struct wb_wire3d *wire, struct wb_solid_support *supports)
{
    const struct wb_solid_mesh *mesh = &wire->mesh;
    const double tolerance = 1e-9 * wire->model->part[wire->model->n_parts - 1].outer_diameter;
    const bool fixed = wire->model->clamp == WB_WIRE_CLAMP_FIXED;
    int n = 0;

    for (int i = 0; i < mesh->n_clamp; i++) {
        const int node = mesh->clamp[i];
        supports[n++] = (struct wb_solid_support){.node = node, .axis = 0};
        for (int axis = 1; axis < 3; axis++)
            if (fixed || fabs(mesh->node[node][axis]) < tolerance)
                supports[n++] = (struct wb_solid_support){.node = node, .axis = axis};
    }
    return n;
}

static enum wb_status make_solid(struct wb_wire3d *wire)
{
    const struct wb_wire_model *m = wire->model;
    struct wb_solid_part parts[WB_WIRE_MODEL_PARTS];
    struct wb_solid_support *const supports =
        wb_memory_new(3 * (size_t)wire->mesh.n_clamp + 1, sizeof *supports);

    for (int p = 0; p < m->n_parts; p++)
        parts[p] =
            (struct wb_solid_part){.material = m->part[p].material, .density = m->part[p].density};
    const struct wb_solid_model model = {
        .mesh = &wire->mesh,
        .parts = parts,
        .integration = m->integration,
        .gravity = {m->gravity[0], m->gravity[1], m->gravity[2]},
        .n_supports = hold_clamp(wire, supports),
        .supports = supports,
        .jacket_contact = m->has_contact ? &m->jacket_contact : NULL,
        .strand_length = m->strand_length,
        .strand_x = m->length,
    };
    const enum wb_status status = wb_solid_create(&wire->solid, &model, NULL);
    free(supports);
    return status;
}

enum wb_status wb_wire3d_create(struct wb_wire3d **out, const struct wb_wire_model *model)
{
    *out = NULL;
    struct wb_wire3d *const wire = wb_memory_new(1, sizeof *wire);
    wire->model = model;

    enum wb_status status = make_mesh(wire);
    if (status == WB_OK)
        status = make_solid(wire);
    if (status != WB_OK)
        wb_wire3d_destroy(wire);
    else
        *out = wire;
    return status;
}

void wb_wire3d_destroy(struct wb_wire3d *wire)
{
    if (!wire)
        return;
    wb_solid_destroy(wire->solid);
    wb_solid_mesh_release(&wire->mesh);
    free(wire);
}

/* Position of the axis at reference arc length s: quadratic within a slice of elements. */
static void axis_at(const struct wb_wire3d *wire, double s, double position[3])
{
    const struct wb_solid_mesh *mesh = &wire->mesh;
    const double *u = wb_solid_displacement(wire->solid);
    const int slices = (mesh->n_axis - 1) / 2;
    const double along = s / wire->model->length * slices;
    const int slice = (int)fmin(fmax(floor(along), 0.0), slices - 1);
    const double t = along - slice;
    const double shape[3] = {(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)};

    position[0] = position[1] = position[2] = 0.0;
    for (int k = 0; k < 3; k++) {
        const int node = mesh->axis[2 * slice + k];
        for (int i = 0; i < 3; i++)
            position[i] += shape[k] * (mesh->node[node][i] + u[3 * node + i]);
    }
}

static void add_row(struct run *r, double fraction)
{
    const struct wb_wire3d *wire = r->wire;
    const struct wb_wire_model *model = wire->model;
    const struct wb_solid_loads *loads = wb_solid_loads(wire->solid);
    struct wb_wire_row row = {.fraction = fraction, .loads = loads->tip};
    struct wb_solid_tip tip;
    double lean = 0.0;

    wb_solid_tip(wire->solid, &tip);
    memcpy(row.tip, tip.position, sizeof row.tip);
    memcpy(row.tangent, tip.frame[0], sizeof row.tangent);
    if (model->strand_length > 0.0)
        lean = hypot(model->length - row.tip[0], row.tip[2]) / model->strand_length;
    wb_wire_run_set_forces(&row, model, loads->tension, loads->tension * sqrt(1.0 - lean * lean),
                           (const double(*)[3])tip.frame);
    for (int k = 0; k < r->at.run->n_shape; k++)
        axis_at(wire, r->at.run->shape_s[k], r->at.run->axis[k]);
    wb_wire_run_end_row(&r->at, &row, r->slack);
}

/* Called by wb_solid_move() after each increment. */
static bool observe(void *context, double fraction, int iterations)
{
    struct run *r = context;
    struct wb_solid_tip tip;
    struct wb_solid_balance balance;

    wb_solid_tip(r->wire->solid, &tip);
    wb_solid_balance(r->wire->solid, &balance);
    r->wire->sliding = fmax(r->wire->sliding, balance.jacket_contact.sliding);
    return wb_wire_run_end_increment(&r->at, tip.frame[0], fraction, iterations);
}

/* Makes one move and adds its iterations and cutbacks to the run; true if it converged. */
static bool move(struct run *r, struct wb_solid_move *move, struct wb_solid_point *point)
{
    move->observer = observe;
    move->context = r;
    r->at.status = wb_solid_move(r->wire->solid, move, point);
    if (r->at.status != WB_OK)
        return false;
    r->at.run->iterations += point->iterations;
    r->at.run->cutbacks += point->cutbacks;
    r->at.run->stopped = r->at.run->stopped || point->end == WB_SOLID_STOPPED;
    return point->end == WB_SOLID_CONVERGED;
}

/* The move to the end of a row: the loads at `share` of the step, which began at `start`. */
static struct wb_solid_move plan_row(const struct run *r, const struct wb_wire_target *start,
                                     double share)
{
    const struct wb_wire_target to =
        wb_wire_run_target(&r->wire->model->step[r->at.step], start, share);
    return (struct wb_solid_move){
        .control = to.is_held ? WB_SOLID_DEFLECTION : WB_SOLID_LOADS,
        .target = {.weight = 1.0, .tip = to.tip, .tension = to.tension},
        .deflection = to.deflection,
    };
}

static double tip_y(const struct run *r)
{
    struct wb_solid_tip tip;
    wb_solid_tip(r->wire->solid, &tip);
    return tip.position[1];
}

/* True if there is room for another row of a path in addition to the planned rows. */
static bool has_room(struct run *r)
{
    int planned = 0;

    for (int i = r->at.step; i < r->wire->model->n_steps; i++)
        planned += r->wire->model->step[i].rows - (i == r->at.step ? r->at.row - 1 : 0);
    if (r->at.run->n_rows + planned < r->at.run->capacity)
        return true;
    snprintf(r->at.run->problem, sizeof r->at.run->problem,
             "step '%s', row %d: paths past limit points take more than %d rows",
             r->wire->model->step[r->at.step].name, r->at.row, WB_WIRE_RUN_SPARE);
    return false;
}

/* A path past a limit point, within one row. */
struct path {
    double share;       /* fraction of the row's load change reached so far */
    int next_try;       /* increment at which to try the row's loads directly */
    int retry_interval; /* increments from a failed attempt to the next; doubles, as each is costly
                         */
};

/* Tries to reach the row's loads from the current point of the path. */
static bool reach_from_path(struct run *r, const struct wb_solid_move *row, struct path *path,
                            int arc)
{
    struct wb_solid_move rest = *row;
    struct wb_solid_point point;

    if (move(r, &rest, &point))
        return true;
    path->share += point.fraction * (1.0 - path->share);
    path->next_try = arc + path->retry_interval;
    path->retry_interval *= 2;
    return false;
}

/* Follows the path past a limit point of the load, with a row for each increment, until the row's
 * loads can be reached again. `share` of the load change was completed before. */
static bool follow_arc(struct run *r, const struct wb_solid_move *row, double from, double to,
                       double share)
{
    struct path path = {.share = share, .retry_interval = 2};
    struct wb_solid_move arc = *row;
    struct wb_solid_point point;

    arc.control = WB_SOLID_ARC;
    arc.arc_length = arc_share * r->wire->model->length;
    for (int i = 0; i < MAX_ARC_INCREMENTS; i++) {
        if (!move(r, &arc, &point))
            return false;
        /* point.fraction is relative to the remaining change of the loads. */
        path.share += point.fraction * (1.0 - path.share);
        add_row(r, fmin(wb_interpolate(from, to, path.share), 0.999999));
        if (r->at.status != WB_OK || r->at.run->stopped)
            return false;
        const bool near = path.share >= 1.0 || (point.fraction > 0.0 && i >= path.next_try);
        if (near && !point.unstable && reach_from_path(r, row, &path, i))
            return true;
        if (r->at.status != WB_OK || r->at.run->stopped)
            return false;
        /* On an unstable branch the row's loads are not an equilibrium of the test: stop. */
        if (path.share >= 1.0 || !has_room(r))
            return false;
    }
    return false;
}

/* Releases a strand that would have to push. */
static bool release_strand(struct run *r, const struct wb_solid_move *row)
{
    struct wb_solid_move release = *row;
    struct wb_solid_point point;

    release.control = WB_SOLID_LOADS;
    release.target.tension = 0.0;
    r->slack = true;
    return move(r, &release, &point);
}

/* Moves to the end of a row; a slack strand stays slack until it becomes taut again. */
static bool reach_row(struct run *r, struct wb_solid_move *row, double from, double to)
{
    struct wb_solid_point point = {0};
    const bool held = row->control == WB_SOLID_DEFLECTION;

    if (r->slack && held && row->deflection <= tip_y(r))
        return true;
    r->slack = r->slack && !held && row->target.tension == 0.0;
    if (move(r, row, &point))
        return true;
    if (point.end == WB_SOLID_SLACK && release_strand(r, row))
        return true;
    snprintf(r->at.run->problem, sizeof r->at.run->problem,
             "step '%s', row %d (%.3g of the row): %s", r->wire->model->step[r->at.step].name,
             r->at.row, point.fraction, point.problem);
    if (r->at.status != WB_OK || r->at.run->stopped || held)
        return false;
    return follow_arc(r, row, from, to, point.fraction);
}

static bool run_step(struct run *r)
{
    const struct wb_wire_step *step = &r->wire->model->step[r->at.step];
    const struct wb_solid_loads *loads = wb_solid_loads(r->wire->solid);
    const struct wb_wire_target start = {
        .tip = loads->tip,
        .tension = loads->tension,
        .deflection = r->slack ? r->held : tip_y(r),
    };

    for (r->at.row = 1; r->at.row <= step->rows; r->at.row++) {
        const double from = (r->at.row - 1.0) / step->rows, to = (double)r->at.row / step->rows;
        struct wb_solid_move row = plan_row(r, &start, to);
        if (!reach_row(r, &row, from, to))
            return false;
        r->held = step->kind == WB_WIRE_STEP_DEFLECTION ? row.deflection : tip_y(r);
        r->at.run->problem[0] = '\0';
        add_row(r, r->at.row == step->rows ? 1.0 : to);
        if (r->at.status != WB_OK || r->at.run->stopped)
            return false;
    }
    return true;
}

/* Applies the weight to the virgin wire; if the first step prescribes a deflection, at deflection
 * zero. */
static bool begin(struct run *r)
{
    const bool level = r->wire->model->step[0].kind == WB_WIRE_STEP_DEFLECTION;
    struct wb_solid_move first = {
        .control = level ? WB_SOLID_DEFLECTION : WB_SOLID_LOADS,
        .target = {.weight = 1.0},
    };
    struct wb_solid_point point = {0};

    if (!move(r, &first, &point) && !(point.end == WB_SOLID_SLACK && release_strand(r, &first))) {
        snprintf(r->at.run->problem, sizeof r->at.run->problem, "under its weight: %s",
                 point.problem);
        return false;
    }
    add_row(r, 0.0);
    return r->at.status == WB_OK && !r->at.run->stopped;
}

/* Virgin again. */
static enum wb_status begin_anew(struct wb_wire3d *wire)
{
    wb_solid_destroy(wire->solid);
    wire->solid = NULL; /* NULL even if wb_solid_create() failed */
    wire->sliding = 0.0;
    return make_solid(wire);
}

enum wb_status wb_wire3d_run(struct wb_wire3d *wire, struct wb_wire_run *run,
                             const struct wb_wire_observer *observer)
{
    struct run r = {
        .wire = wire,
        .at = {.run = run, .model = wire->model, .observer = observer, .status = WB_OK},
    };

    if (wire->has_run)
        WB_TRY(begin_anew(wire));
    wire->has_run = true;
    run->n_elements = wire->mesh.n_elements;
    run->n_unknowns = wb_solid_unknowns(wire->solid);
    run->converged = begin(&r);
    for (r.at.step = 0; run->converged && r.at.step < wire->model->n_steps; r.at.step++)
        run->converged = run_step(&r);
    if (run->stopped)
        run->converged = true;
    return r.at.status;
}

const struct wb_solid_mesh *wb_wire3d_mesh(const struct wb_wire3d *wire)
{
    return &wire->mesh;
}

/* Replaces the elements' values at a node by their mean over the elements of one part. */
static void average_by_part(const struct wb_solid_mesh *mesh, struct wb_wire3d_fields *fields)
{
    enum {
        VALUES = 7
    };
    const size_t places = (size_t)mesh->n_nodes * (size_t)mesh->n_parts;
    double(*const sum)[VALUES] = wb_memory_new(places, sizeof *sum);
    int *const count = wb_memory_new(places, sizeof *count);

    for (int pass = 0; pass < 2; pass++)
        for (int e = 0; e < mesh->n_elements; e++)
            for (int k = 0; k < WB_SOLID_MESH_NODES; k++) {
                const size_t at =
                    (size_t)mesh->element[e][k] * (size_t)mesh->n_parts + (size_t)mesh->part[e];
                for (int i = 0; i < VALUES; i++) {
                    double *value = i < 6 ? &fields->stress[e][k][i] : &fields->plastic[e][k];
                    if (pass == 0)
                        sum[at][i] += *value;
                    else
                        *value = sum[at][i] / count[at];
                }
                count[at] += pass == 0;
            }
    free(sum);
    free(count);
}

/* Extrapolation from the points inside an element overshoots at the border of the plastic zone:
 * scale each deviator down to the flow stress of the node's plastic strain. */
static void limit_to_flow_stress(const struct wb_wire3d *wire, struct wb_wire3d_fields *fields)
{
    const struct wb_solid_mesh *mesh = &wire->mesh;

    for (int e = 0; e < mesh->n_elements; e++)
        for (int k = 0; k < WB_SOLID_MESH_NODES; k++) {
            const double flow = wb_material_flow_stress(&wire->model->part[mesh->part[e]].material,
                                                        fields->plastic[e][k]);
            double *s = fields->stress[e][k];
            const double mean = (s[0] + s[1] + s[2]) / 3.0;
            const double a = s[0] - mean, b = s[1] - mean, c = s[2] - mean;
            const double mises = sqrt(1.5 * (a * a + b * b + c * c) +
                                      3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
            for (int i = 0; mises > flow && i < 6; i++)
                s[i] = (i < 3 ? mean : 0.0) + (s[i] - (i < 3 ? mean : 0.0)) * flow / mises;
        }
}

void wb_wire3d_fields(const struct wb_wire3d *wire, struct wb_wire3d_fields *fields)
{
    const struct wb_solid_mesh *mesh = &wire->mesh;
    const double *u = wb_solid_displacement(wire->solid);

    *fields = (struct wb_wire3d_fields){
        .position = wb_memory_new((size_t)mesh->n_nodes, sizeof *fields->position),
        .stress = wb_memory_new((size_t)mesh->n_elements, sizeof *fields->stress),
        .plastic = wb_memory_new((size_t)mesh->n_elements, sizeof *fields->plastic),
    };
    for (int a = 0; a < mesh->n_nodes; a++)
        for (int i = 0; i < 3; i++)
            fields->position[a][i] = mesh->node[a][i] + u[3 * a + i];
    for (int e = 0; e < mesh->n_elements; e++)
        wb_solid_nodal_stress(wire->solid, e, fields->stress[e], fields->plastic[e]);
    average_by_part(mesh, fields);
    limit_to_flow_stress(wire, fields);
}

void wb_wire3d_fields_release(struct wb_wire3d_fields *fields)
{
    free(fields->position);
    free(fields->stress);
    free(fields->plastic);
    *fields = (struct wb_wire3d_fields){0};
}

/* Shorter side of an element's face on the interface, m. */
static double shorter_side(const struct wb_wire_model *model)
{
    const double around = M_PI * model->part[0].outer_diameter / (8 * model->section_density);
    return fmin(model->length / model->elements_along, around);
}

void wb_wire3d_balance(const struct wb_wire3d *wire, struct wb_wire3d_balance *balance)
{
    struct wb_solid_balance b;

    wb_solid_balance(wire->solid, &b);
    *balance = (struct wb_wire3d_balance){
        .penetration = b.jacket_contact.penetration,
        .opening = b.jacket_contact.opening,
        .slip = b.jacket_contact.slip,
        .sliding = wire->sliding,
        .slip_limit = slip_share * shorter_side(wire->model),
        .work = b.work,
        .elastic = b.elastic,
        .dissipated = b.dissipated,
        .friction = b.friction,
    };
}
