#include "fe/bundle/bundle.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/units.h"
#include "fe/bundle/bundle_bond.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/bundle/bundle_private.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    SETTLE_BLOCK = 20,    /* steps between looks at the kinetic energy */
    SETTLE_WATCH = 200,   /* steps between looks of the caller */
    SETTLE_MOST = 400000, /* steps */
    SETTLE_QUIET = 10     /* stops in a row with little motion */
};

/* At rest: kinetic energy over the weight's work. */
static const double settled = 1e-7;

double wb_bundle_internal(const struct wb_bundle_energies *e)
{
    return e->stored + e->plastic + e->contact + e->cohesive;
}

double wb_bundle_imbalance(const struct wb_bundle_energies *e)
{
    return e->external - e->kinetic - wb_bundle_internal(e) - e->artificial - e->friction;
}

double wb_bundle_time_step(const struct wb_bundle *bundle)
{
    return bundle->time_step;
}

long wb_bundle_hexahedra(const struct wb_bundle *bundle)
{
    return wb_bundle_model_hexahedra(bundle->model, bundle->mesh);
}

int wb_bundle_shells(const struct wb_bundle *bundle)
{
    return bundle->has_tape ? wb_swept_tape_elements(bundle->tape) * (bundle->n_stations - 1) : 0;
}

double wb_bundle_station_mass(const struct wb_bundle *bundle, const struct wb_bundle_body *body,
                              int station)
{
    const int in_whole = bundle->first + station;
    const bool end = in_whole == 0 || in_whole == bundle->n_whole - 1;
    return body->mass * bundle->spacing * (end ? 0.5 : 1.0) * bundle->model->run.mass_scaling;
}

/* --- the tip --- */

/* Sums over the end station of all bodies, weighted by masses: of a field's component. */
static double tip_mean(const struct wb_bundle *bundle, const struct wb_bundle_body *body,
                       const double *field, int component)
{
    const int j = bundle->n_stations - 1, stride = body->layout.stride;
    double sum = 0.0;

    for (int k = 0; k < body->layout.n_nodes; k++)
        sum += body->node_mass[k] * field[(3 * k + component) * stride + j];
    return sum / body->mass;
}

double wb_bundle_force_at(const struct wb_bundle_body *body, size_t at)
{
    return body->is_double ? ((const double *)body->force)[at]
                           : (double)((const float *)body->force)[at];
}

void wb_bundle_add_force(struct wb_bundle_body *body, size_t at, double force)
{
    if (body->is_double)
        ((double *)body->force)[at] += force;
    else
        ((float *)body->force)[at] += (float)force;
}

size_t wb_bundle_force_size(const struct wb_bundle_body *body)
{
    return body->is_double ? sizeof(double) : sizeof(float);
}

static double tip_force(const struct wb_bundle *bundle, const struct wb_bundle_body *body,
                        int component)
{
    const int j = bundle->n_stations - 1, stride = body->layout.stride;
    double sum = 0.0;

    for (int k = 0; k < body->layout.n_nodes; k++)
        sum += wb_bundle_force_at(body, (size_t)((3 * k + component) * stride + j));
    return sum;
}

/* Spreads a force over the end by its masses, so that it accelerates all of it alike. */
static void push_tip(struct wb_bundle *bundle, struct wb_bundle_body *body, const double force[3],
                     double whole)
{
    const int j = bundle->n_stations - 1, stride = body->layout.stride;

    for (int k = 0; k < body->layout.n_nodes; k++)
        for (int c = 0; c < 3; c++)
            wb_bundle_add_force(body, (size_t)((3 * k + c) * stride + j),
                                force[c] * body->node_mass[k] / whole);
}

/* Calls for every body that has mass at the tip. */
static int tip_bodies(struct wb_bundle *bundle, struct wb_bundle_body *body[WB_PACKING_MOST + 1])
{
    int n = 0;
    for (int w = 0; w < bundle->n_wires; w++)
        body[n++] = &bundle->wire[w];
    if (bundle->has_tape)
        body[n++] = &bundle->ring;
    return n;
}

struct tip {
    double mass;                  /* kg, scaled, of the end station */
    double weight;                /* sum of unscaled masses per length, kg/m */
    double position[3], velocity; /* means; of the height */
    double force;                 /* N, vertical, of all that acts */
};

static void look_at_tip(struct wb_bundle *bundle, struct tip *tip)
{
    struct wb_bundle_body *body[WB_PACKING_MOST + 1];
    const int n = tip_bodies(bundle, body);

    *tip = (struct tip){0};
    for (int i = 0; i < n; i++) {
        const double m = body[i]->mass;
        tip->weight += m;
        tip->mass += wb_bundle_station_mass(bundle, body[i], bundle->n_stations - 1);
        for (int c = 0; c < 3; c++)
            tip->position[c] += m * tip_mean(bundle, body[i], body[i]->position, c);
        tip->position[1] -= m * body[i]->start;
        tip->velocity += m * tip_mean(bundle, body[i], body[i]->velocity, 1);
        tip->force += tip_force(bundle, body[i], 1);
    }
    for (int c = 0; c < 3; c++)
        tip->position[c] /= tip->weight;
    tip->velocity /= tip->weight;
}

/* Fifth-order smooth step: rest, speed and acceleration zero at both ends. */
static double smooth(double t)
{
    if (t <= 0.0)
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

static double target_at(const struct wb_bundle *bundle, double time)
{
    return bundle->from +
           (bundle->to - bundle->from) * smooth((time - bundle->way_start) / bundle->way_duration);
}

/* The force that brings the tip's mean height to its target in this step. A strand leans as the
 * tip comes nearer and only pulls. */
static enum wb_status lead_tip(struct wb_bundle *bundle, double half)
{
    const double least_upright = 0.1;
    const double dt = bundle->time_step, length = bundle->model->loads.strand_length;
    struct wb_bundle_body *body[WB_PACKING_MOST + 1];
    const int n = tip_bodies(bundle, body);
    struct tip tip;
    double lean[2] = {0.0, 0.0}, upright = 1.0;

    if (bundle->let_go) {
        bundle->slack = true;
        bundle->tension = bundle->vertical = 0.0;
        memset(bundle->pull, 0, sizeof bundle->pull);
        return WB_OK;
    }
    look_at_tip(bundle, &tip);
    const double wanted = (target_at(bundle, bundle->time + dt) - tip.position[1]) / dt;
    const double gravity = bundle->gravity / bundle->model->run.mass_scaling;
    const double vertical =
        tip.mass * ((wanted - tip.velocity) / (half * dt) + gravity) - tip.force;
    if (length > 0.0) {
        lean[0] = (bundle->model->length - tip.position[0]) / length;
        lean[1] = -tip.position[2] / length;
        upright = sqrt(fmax(0.0, 1.0 - lean[0] * lean[0] - lean[1] * lean[1]));
        if (upright < least_upright)
            return wb_fail(
                WB_ERR_DATA,
                "%s: the run is lost after %lld steps: the tip is %.3g mm from where the "
                "strand of %.3g mm would hang upright; it has to be longer",
                bundle->model->path, bundle->steps, hypot(lean[0], lean[1]) * length / WB_MM,
                length / WB_MM);
    }
    bundle->slack = length > 0.0 && vertical < 0.0;
    bundle->vertical = bundle->slack ? 0.0 : vertical;
    bundle->tension = bundle->vertical / upright;

    bundle->pull[0] = bundle->tension * lean[0];
    bundle->pull[1] = bundle->vertical;
    bundle->pull[2] = bundle->tension * lean[1];
    for (int i = 0; i < n; i++)
        push_tip(bundle, body[i], bundle->pull, tip.weight);
    return WB_OK;
}

/* --- steps --- */

/* Nothing but the elements acts on nodes inside a section. */
static void clear_outline(struct wb_bundle *bundle, int w)
{
    struct wb_bundle_body *body = &bundle->wire[w];
    const size_t size = wb_bundle_force_size(body);
    const int first = wb_swept_hex_first_added(bundle->type[bundle->model->type_of[w]].hex);
    const size_t inside = 3 * (size_t)first * (size_t)body->layout.stride;

    memset((unsigned char *)body->force + inside * size, 0,
           (wb_swept_size(&body->layout) - inside) * size);
}

/* Of all but the wires' elements, which add theirs (advance_wire()). */
static enum wb_status find_forces(struct wb_bundle *bundle, bool look)
{
    bundle->shells = (struct wb_swept_tape_sums){0};
    for (int w = 0; w < bundle->n_wires; w++)
        clear_outline(bundle, w);
    if (bundle->has_tape) {
        const struct wb_swept_tape_fields fields = {
            .position = bundle->ring.position,
            .director = bundle->directors.position,
            .force = bundle->ring.force,
            .moment = bundle->directors.force,
        };
        wb_swept_tape_forces(bundle->tape_history, &fields, 0, wb_swept_tape_blocks(bundle->tape),
                             look ? &bundle->shells : NULL);
    }
    if (bundle->contact) {
        WB_TRY(wb_swept_contact_add_forces(bundle->contact, bundle->positions, bundle->forces,
                                           bundle->time_step, &bundle->touching));
        bundle->friction_work += bundle->touching.friction;
    }
    if (bundle->bond) {
        WB_TRY(wb_bundle_bond_add_forces(bundle->bond, &bundle->bonded));
        bundle->damage_work += bundle->bonded.dissipated;
        bundle->friction_work += bundle->bonded.friction;
    }
    return WB_OK;
}

/* Blocks of the stations that are its own. */
static struct wb_swept_range own_blocks(const struct wb_bundle *bundle)
{
    return (struct wb_swept_range){bundle->own.first / WB_SWEPT_LANES,
                                   (bundle->own.end + WB_SWEPT_LANES - 1) / WB_SWEPT_LANES};
}

static void update(const struct wb_bundle *bundle, struct wb_bundle_body *body, double half,
                   struct wb_swept_range blocks, struct wb_swept_step_sums *sums)
{
    const struct wb_swept_step_fields fields = {body->position, body->velocity, body->force};
    const double times[2] = {half * bundle->time_step, bundle->time_step};

    wb_swept_step_update(body->step, &fields, times, blocks.first, blocks.end, sums);
}

/* The elements' forces of one wire, and its step, block by block: each is read and written while it
 * is near. The blocks from `last` on wait for the tip's force. */
static void advance_wire(struct wb_bundle *bundle, int w, double half, int last, bool look,
                         struct wb_swept_step_sums *sums)
{
    struct wb_bundle_body *body = &bundle->wire[w];
    const struct wb_swept_range own = own_blocks(bundle);
    const int n = wb_swept_hex_blocks(bundle->type[bundle->model->type_of[w]].hex);
    const struct wb_swept_hex_fields fields = {body->position, body->force,
                                               bundle->is_large ? body->velocity : NULL};

    for (int b = 0; b < n; b++) {
        wb_swept_hex_add_forces(bundle->history[w], &fields, b, b + 1,
                                look ? &bundle->wires : NULL);
        if (b >= own.first && b < own.end && b < last)
            update(bundle, body, half, (struct wb_swept_range){b, b + 1}, sums);
    }
}

/* Where the tip belongs to another part. */
static bool has_tip(const struct wb_bundle *bundle)
{
    return bundle->first + bundle->own.end == bundle->n_whole;
}

static void count_tip_work(struct wb_bundle *bundle, const struct tip *before)
{
    struct tip after;

    look_at_tip(bundle, &after);
    bundle->tip_work += bundle->vertical * (after.position[1] - before->position[1]);
    bundle->tip_work += bundle->pull[0] * (after.position[0] - before->position[0]) +
                        bundle->pull[2] * (after.position[2] - before->position[2]);
}

enum wb_status wb_bundle_step(struct wb_bundle *bundle, bool look)
{
    const double half = bundle->has_moved ? 1.0 : 0.5;
    const struct wb_swept_range own = own_blocks(bundle);
    const int last = has_tip(bundle) ? own.end - 1 : own.end;
    struct wb_swept_step_sums sums = {0}, *wanted = look ? &sums : NULL;
    struct tip before = {0};

    WB_TRY(find_forces(bundle, look));
    bundle->wires = (struct wb_swept_hex_sums){0};
    for (int w = 0; w < bundle->n_wires; w++)
        advance_wire(bundle, w, half, last, look, wanted);
    if (has_tip(bundle)) {
        look_at_tip(bundle, &before);
        WB_TRY(lead_tip(bundle, half));
    }
    if (bundle->cap)
        wb_bundle_cap_advance(bundle->cap, half);
    for (int w = 0; w < bundle->n_wires; w++)
        update(bundle, &bundle->wire[w], half, (struct wb_swept_range){last, own.end}, wanted);
    if (bundle->has_tape) {
        update(bundle, &bundle->ring, half, own, wanted);
        update(bundle, &bundle->directors, half, own, wanted);
    }
    bundle->has_moved = true;
    if (look)
        bundle->kinetic = sums.kinetic + (bundle->cap ? wb_bundle_cap_kinetic(bundle->cap) : 0.0);
    bundle->time += bundle->time_step;
    bundle->steps++;

    if (has_tip(bundle))
        count_tip_work(bundle, &before);
    return isfinite(bundle->vertical)
               ? WB_OK
               : wb_fail(WB_ERR_DATA,
                         "%s: the run is lost after %lld steps: the tip's force is "
                         "not finite",
                         bundle->model->path, bundle->steps);
}

enum wb_status wb_bundle_advance(struct wb_bundle *bundle, int n)
{
    if (bundle->parts)
        return wb_bundle_parts_advance(bundle->parts, n);
    for (int i = 0; i < n; i++)
        WB_TRY(wb_bundle_step(bundle, i == n - 1));
    return WB_OK;
}

void wb_bundle_lead(struct wb_bundle *bundle, double deflection, double duration)
{
    bundle->from = target_at(bundle, bundle->time);
    bundle->to = deflection;
    bundle->way_start = bundle->time;
    bundle->way_duration = duration;
    bundle->let_go = false;
}

/* --- settling --- */

static void stop_body(struct wb_bundle_body *body)
{
    memset(body->velocity, 0, wb_swept_size(&body->layout) * sizeof *body->velocity);
}

void wb_bundle_stop(struct wb_bundle *bundle)
{
    for (int w = 0; w < bundle->n_wires; w++)
        stop_body(&bundle->wire[w]);
    if (bundle->has_tape) {
        stop_body(&bundle->ring);
        stop_body(&bundle->directors);
    }
    if (bundle->cap)
        wb_bundle_cap_stop(bundle->cap);
    if (bundle->parts)
        wb_bundle_parts_stop(bundle->parts);
    bundle->has_moved = false;
}

/* A body's part of the weight's potential, J. */
static double potential_of(const struct wb_bundle *bundle, const struct wb_bundle_body *body)
{
    const int last = bundle->n_whole - 1 - bundle->first;
    double sum = 0.0;

    for (int k = 0; k < body->layout.n_nodes; k++) {
        const double *y = body->position + (ptrdiff_t)(3 * k + 1) * body->layout.stride;
        double heights = 0.0;
        for (int j = bundle->own.first; j < bundle->own.end; j++)
            heights += bundle->first + j == 0 || j == last ? 0.5 * y[j] : y[j];
        sum += body->node_mass[k] * heights;
    }
    return sum * bundle->spacing * bundle->gravity;
}

double wb_bundle_potential(const struct wb_bundle *bundle)
{
    double sum = 0.0;

    if (bundle->parts)
        return wb_bundle_parts_potential(bundle->parts);
    for (int w = 0; w < bundle->n_wires; w++)
        sum += potential_of(bundle, &bundle->wire[w]);
    return sum + (bundle->has_tape ? potential_of(bundle, &bundle->ring) : 0.0);
}

/* Motion is stopped whenever its energy begins to fall, until it is small beside the work that was
 * done; whoever stops it takes its energy away. */
static enum wb_status come_to_rest(struct wb_bundle *bundle, const struct wb_bundle_watch *watch)
{
    double last = 0.0;
    int quiet = 0;

    for (int done = 0; quiet < SETTLE_QUIET; done += SETTLE_BLOCK) {
        if (done > SETTLE_MOST)
            return wb_fail(WB_ERR_CONVERGENCE,
                           "%s: the bundle does not come to rest within %d "
                           "steps",
                           bundle->model->path, SETTLE_MOST);
        if (watch && done % SETTLE_WATCH == 0 && !watch->goes_on(watch->context))
            return WB_OK;
        WB_TRY(wb_bundle_advance(bundle, SETTLE_BLOCK));
        if (bundle->kinetic >= last) {
            last = bundle->kinetic;
            continue;
        }
        const double work =
            fabs(bundle->weight_zero - wb_bundle_potential(bundle)) + fabs(bundle->tip_work);
        quiet = last < settled * work ? quiet + 1 : 0;
        wb_bundle_stop(bundle);
        bundle->tip_work -= bundle->kinetic;
        bundle->kinetic = last = 0.0;
    }
    return WB_OK;
}

enum wb_status wb_bundle_settle(struct wb_bundle *bundle, const struct wb_bundle_watch *watch)
{
    bundle->from = bundle->to = 0.0;
    bundle->way_start = 0.0;
    bundle->way_duration = 1.0;
    bundle->weight_zero = wb_bundle_potential(bundle);
    if (bundle->gravity == 0.0)
        return WB_OK;
    WB_TRY(come_to_rest(bundle, watch));
    /* The account begins here. */
    struct wb_bundle_energies now;
    wb_bundle_get_energies(bundle, &now);
    bundle->tip_work +=
        now.kinetic + wb_bundle_internal(&now) + now.artificial + now.friction - now.external;
    bundle->time = 0.0;
    bundle->way_start = 0.0;
    return WB_OK;
}

enum wb_status wb_bundle_let_go(struct wb_bundle *bundle, const struct wb_bundle_watch *watch)
{
    struct wb_bundle_state state;

    bundle->let_go = true;
    WB_TRY(come_to_rest(bundle, watch));
    wb_bundle_get_state(bundle, &state);
    bundle->from = bundle->to = state.deflection;
    return WB_OK;
}

/* --- what it tells --- */

void wb_bundle_get_state(const struct wb_bundle *bundle, struct wb_bundle_state *state)
{
    struct tip tip;

    look_at_tip((struct wb_bundle *)bundle, &tip);
    *state = (struct wb_bundle_state){
        .time = bundle->time,
        .steps = bundle->steps,
        .deflection = tip.position[1],
        .target = target_at(bundle, bundle->time),
        .tip = {tip.position[0], tip.position[1], tip.position[2]},
        .tension = bundle->tension,
        .vertical = bundle->vertical,
        .slack = bundle->slack,
    };
}

double wb_bundle_plastic_work(const struct wb_bundle *bundle)
{
    double plastic = 0.0;

    if (bundle->parts)
        return wb_bundle_parts_plastic_work(bundle->parts);
    for (int w = 0; w < bundle->n_wires; w++)
        plastic += wb_swept_hex_plastic_work(bundle->history[w]);
    if (bundle->has_tape)
        plastic += wb_swept_tape_plastic_work(bundle->tape_history);
    return plastic;
}

void wb_bundle_get_energies(const struct wb_bundle *bundle, struct wb_bundle_energies *energies)
{
    *energies = (struct wb_bundle_energies){
        .kinetic = bundle->kinetic,
        .stored = bundle->wires.stored + bundle->shells.stored,
        .plastic = wb_bundle_plastic_work(bundle),
        .artificial = bundle->wires.artificial + bundle->shells.artificial,
        .contact = bundle->touching.normal + bundle->touching.tangential + bundle->bonded.contact,
        .friction = bundle->friction_work,
        .cohesive = bundle->bonded.stored + bundle->damage_work,
        .external = bundle->tip_work + bundle->weight_zero - wb_bundle_potential(bundle),
    };
}

int wb_bundle_last_held(const struct wb_bundle *bundle)
{
    return (int)floor(bundle->model->potted_length / bundle->spacing + 1e-9);
}

/* Adds a body's part. */
static void add_outside(const struct wb_bundle *bundle, const struct wb_bundle_body *body,
                        struct wb_bundle_outside *out)
{
    const int held = wb_bundle_last_held(bundle), stride = body->layout.stride;

    for (int j = 0; j < bundle->n_stations; j++) {
        const double mass = wb_bundle_station_mass(bundle, body, j);
        const double weight = -bundle->gravity * mass / bundle->model->run.mass_scaling;
        out->weight[1] += weight;
        if (j <= held)
            out->clamp[1] -= weight;
        for (int i = 0; i < 3 * body->layout.n_nodes; i++) {
            const size_t at = (size_t)i * (size_t)stride + (size_t)j;
            if (j <= held)
                out->clamp[i % 3] -= wb_bundle_force_at(body, at);
            out->momentum[i % 3] += mass * body->node_mass[i / 3] / body->mass * body->velocity[at];
        }
    }
}

void wb_bundle_get_outside(const struct wb_bundle *bundle, struct wb_bundle_outside *outside)
{
    wb_bundle_gather(bundle);
    *outside = (struct wb_bundle_outside){
        .tip = {bundle->pull[0], bundle->pull[1], bundle->pull[2]},
    };
    for (int w = 0; w < bundle->n_wires; w++)
        add_outside(bundle, &bundle->wire[w], outside);
    if (bundle->has_tape)
        add_outside(bundle, &bundle->ring, outside);
}

double wb_bundle_kinetic_ratio(const struct wb_bundle *bundle)
{
    const double external = bundle->tip_work + bundle->weight_zero - wb_bundle_potential(bundle);
    const double internal = external - bundle->kinetic;
    return internal > 0.0 ? bundle->kinetic / internal : (double)INFINITY;
}

void wb_bundle_gather(const struct wb_bundle *bundle)
{
    if (bundle->parts)
        wb_bundle_parts_gather(bundle->parts);
}

int wb_bundle_parts(const struct wb_bundle *bundle)
{
    return bundle->parts ? wb_bundle_parts_count(bundle->parts) : 1;
}

void wb_bundle_shape(const struct wb_bundle *bundle, int n, const double *s, double (*shape)[3])
{
    wb_bundle_gather(bundle);
    for (int i = 0; i < n; i++) {
        const double along = fmin(fmax(s[i] / bundle->spacing, 0.0), bundle->n_stations - 1.0);
        const int j = (int)fmin(floor(along), bundle->n_stations - 2.0);
        const double t = along - j;
        double mass = 0.0, height = 0.0;

        shape[i][0] = shape[i][1] = shape[i][2] = 0.0;
        for (int w = 0; w < bundle->n_wires; w++) {
            const struct wb_bundle_body *body = &bundle->wire[w];
            for (int k = 0; k < body->layout.n_nodes; k++)
                for (int c = 0; c < 3; c++) {
                    const double *x =
                        body->position + (ptrdiff_t)(3 * k + c) * body->layout.stride + j;
                    shape[i][c] += body->node_mass[k] * ((1.0 - t) * x[0] + t * x[1]);
                }
            mass += body->mass;
            height += body->mass * body->start;
        }
        for (int c = 0; c < 3; c++)
            shape[i][c] /= mass;
        shape[i][1] -= height / mass;
    }
}

/* Share of the bonded area whose bond is broken. */
static double debonded(const struct wb_bundle *bundle)
{
    double area[2] = {0.0, 0.0};

    if (!bundle->bond)
        return 0.0;
    if (bundle->parts)
        wb_bundle_parts_add_bonds(bundle->parts, area);
    else
        wb_bundle_bond_add_areas(bundle->bond, area);
    return area[0] > 0.0 ? area[1] / area[0] : 0.0;
}

void wb_bundle_get_limits(const struct wb_bundle *bundle, struct wb_bundle_limits *limits)
{
    *limits = (struct wb_bundle_limits){
        .beyond = bundle->wires.beyond_limit + bundle->shells.beyond_limit,
        .largest_strain = fmax(bundle->wires.largest_strain, bundle->shells.largest_strain),
        .deepest = bundle->touching.deepest,
        .tape_deepest = bundle->bonded.deepest,
        .debonded = debonded(bundle),
    };
}
