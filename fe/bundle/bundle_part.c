#include "fe/bundle/bundle_part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/bundle/bundle_tape.h"
#include "fe/swept/swept_frequency.h"

#define WB_LOG_DOMAIN "bundle"

/* --- creation --- */

static enum wb_status make_contact(struct wb_bundle_part *part)
{
    const struct wb_bundle_bodies *bodies = &part->bodies;
    const struct wb_bundle_model *model = bodies->model;
    struct wb_swept_wire wires[WB_PACKING_MOST];
    struct wb_swept_contact_settings settings;

    if (bodies->n_wires < 2)
        return WB_OK;
    wb_swept_contact_default_settings(&settings);
    settings.friction = model->interface.friction;
    settings.counted = bodies->extent.own;
    settings.double_precision = model->run.double_precision;
    settings.reason = &part->reason;
    wb_bundle_bodies_describe(bodies, wires);
    return wb_swept_contact_create(&part->contact, &settings, bodies->n_wires, wires,
                                   bodies->extent.n_stations, bodies->spacing);
}

/* Fixes the clamp's stations, and those of other parts, whose positions are received. */
static void hold_stations(const struct wb_bundle_bodies *bodies)
{
    const struct wb_bundle_extent *extent = &bodies->extent;
    const int last = wb_bundle_bodies_last_held(bodies) - extent->first;

    for (int j = 0; j < extent->n_stations; j++)
        if (j <= last || j < extent->own.first || j >= extent->own.end)
            wb_bundle_bodies_hold(bodies, j);
}

/* `whole` is NULL for the complete bundle. */
static enum wb_status build(struct wb_bundle_part *part, const struct wb_bundle_part *whole)
{
    struct wb_bundle_bodies *bodies = &part->bodies;
    const struct wb_bundle_model *model = bodies->model;

    WB_TRY(make_contact(part));
    if (model->has_tape) {
        WB_TRY(wb_bundle_tape_create(bodies, whole ? &whole->bodies : NULL));
        WB_TRY(wb_bundle_bond_create(&part->bond, bodies, &part->reason));
    }
    hold_stations(bodies);
    /* Only the part that owns the tip has the cap, not one with the tip in its halo. */
    if (model->tip == WB_BUNDLE_TIP_CAPPED && wb_bundle_bodies_have_tip(bodies))
        part->cap = wb_bundle_cap_create(bodies);
    return WB_OK;
}

static enum wb_status create(struct wb_bundle_part **out, const struct wb_bundle_model *model,
                             const struct wb_bundle_mesh *mesh,
                             const struct wb_bundle_extent *extent,
                             const struct wb_bundle_part *whole)
{
    *out = NULL;
    struct wb_bundle_part *const part = wb_memory_new(1, sizeof *part);
    enum wb_status status = wb_bundle_bodies_init(&part->bodies, model, mesh, extent);
    if (status == WB_OK)
        status = build(part, whole);
    if (status != WB_OK)
        wb_bundle_part_destroy(part);
    else
        *out = part;
    return status;
}

/* Largest omega^2 of a wire with mass scaling, contact and bonds. */
static enum wb_status bound_wire(const struct wb_bundle_part *part, int w, double *square)
{
    const struct wb_bundle_bodies *bodies = &part->bodies;
    const struct wb_bundle_run *run = &bodies->model->run;
    const struct wb_bundle_type *type = &bodies->type[bodies->model->type_of[w]];
    const int n = type->section.n_nodes;
    double omega, added = 0.0;

    double *const mass = wb_memory_new((size_t)n, sizeof *mass);
    for (int k = 0; k < n; k++)
        mass[k] = type->node_mass[k] * bodies->spacing * run->mass_scaling;
    const enum wb_status status =
        wb_swept_frequency_bound(type->hex, type->node_mass, run->selective, &omega);
    if (status == WB_OK && part->contact)
        added =
            wb_swept_contact_stiffness_per_mass(part->contact, w, type->node_mass, run->selective) /
            run->mass_scaling;
    if (status == WB_OK && part->bond)
        added += wb_bundle_bond_wire_stiffness(part->bond, w, mass);
    free(mass);
    if (status != WB_OK)
        return status;
    *square = omega * omega / run->mass_scaling + added;
    return WB_OK;
}

static enum wb_status find_time_step(struct wb_bundle_part *part, double safety)
{
    struct wb_bundle_bodies *bodies = &part->bodies;
    const double mass_scaling = bodies->model->run.mass_scaling;
    double largest = 0.0;

    for (int w = 0; w < bodies->n_wires; w++) {
        double square;
        WB_TRY(bound_wire(part, w, &square));
        largest = fmax(largest, square);
    }
    if (bodies->has_tape) {
        double tape;
        WB_TRY(wb_swept_tape_stiffness_per_mass(bodies->tape, &tape));
        largest = fmax(largest, tape / mass_scaling + wb_bundle_bond_ring_stiffness(part->bond));
    }
    bodies->time_step = safety * 2.0 / sqrt(largest);
    return isfinite(bodies->time_step) && bodies->time_step > 0.0
               ? WB_OK
               : wb_fail(WB_ERR_ARGUMENT,
                         "%s: the stable time step is %g s: expected a number above 0",
                         bodies->model->path, bodies->time_step);
}

enum wb_status wb_bundle_part_create_whole(struct wb_bundle_part **out,
                                           const struct wb_bundle_model *model,
                                           const struct wb_bundle_mesh *mesh, double safety)
{
    const int n = mesh->elements_along + 1;
    const struct wb_bundle_extent extent = {.n_stations = n, .n_whole = n, .own = {0, n}};

    WB_TRY(create(out, model, mesh, &extent, NULL));
    const enum wb_status status = find_time_step(*out, safety);
    if (status != WB_OK) {
        wb_bundle_part_destroy(*out);
        *out = NULL;
    }
    return status;
}

enum wb_status wb_bundle_part_create(struct wb_bundle_part **out,
                                     const struct wb_bundle_part *whole, int first, int n_stations,
                                     struct wb_swept_range own)
{
    const struct wb_bundle_bodies *bodies = &whole->bodies;
    const struct wb_bundle_extent extent = {
        .first = first, .n_stations = n_stations, .n_whole = bodies->extent.n_whole, .own = own};

    WB_TRY(create(out, bodies->model, bodies->mesh, &extent, whole));
    (*out)->bodies.time_step = bodies->time_step;
    (*out)->tip_path = whole->tip_path;
    return WB_OK;
}

void wb_bundle_part_destroy(struct wb_bundle_part *part)
{
    if (!part)
        return;
    wb_bundle_cap_destroy(part->cap);
    wb_bundle_bond_destroy(part->bond);
    wb_swept_contact_destroy(part->contact);
    wb_bundle_bodies_release(&part->bodies);
    free(part);
}

/* --- the tip --- */

/* Mass-weighted mean of a field's component over the end station's nodes. */
static double tip_mean(const struct wb_bundle_body *body, const double *field, int component)
{
    const int j = body->layout.n_stations - 1, stride = body->layout.stride;
    double sum = 0.0;

    for (int k = 0; k < body->layout.n_nodes; k++)
        sum += body->node_mass[k] * field[(3 * k + component) * stride + j];
    return sum / body->mass;
}

static double tip_force(const struct wb_bundle_body *body, int component)
{
    const int j = body->layout.n_stations - 1, stride = body->layout.stride;
    double sum = 0.0;

    for (int k = 0; k < body->layout.n_nodes; k++)
        sum += wb_bundle_body_force(body, (size_t)((3 * k + component) * stride + j));
    return sum;
}

/* Distributes a force over the end in proportion to its masses, for uniform acceleration. */
static void distribute_tip_force(struct wb_bundle_body *body, const double force[3], double whole)
{
    const int j = body->layout.n_stations - 1, stride = body->layout.stride;

    for (int k = 0; k < body->layout.n_nodes; k++)
        for (int c = 0; c < 3; c++)
            wb_bundle_body_add_force(body, (size_t)((3 * k + c) * stride + j),
                                     force[c] * body->node_mass[k] / whole);
}

/* Bodies that have mass at the tip: the i-th, NULL after the last. */
static const struct wb_bundle_body *tip_body(const struct wb_bundle_bodies *bodies, int i)
{
    if (i < bodies->n_wires)
        return &bodies->wire[i];
    return i == bodies->n_wires && bodies->has_tape ? &bodies->ring : NULL;
}

struct tip {
    double mass;                  /* of the end station, scaled, kg */
    double weight;                /* sum of unscaled masses per length, kg/m */
    double position[3], velocity; /* means; velocity: of the height */
    double force;                 /* vertical, of all forces, N */
};

static void look_at_tip(const struct wb_bundle_bodies *bodies, struct tip *tip)
{
    const struct wb_bundle_body *body;

    *tip = (struct tip){0};
    for (int i = 0; (body = tip_body(bodies, i)); i++) {
        const double m = body->mass;
        tip->weight += m;
        tip->mass += wb_bundle_bodies_station_mass(bodies, body, bodies->extent.n_stations - 1);
        for (int c = 0; c < 3; c++)
            tip->position[c] += m * tip_mean(body, body->position, c);
        tip->position[1] -= m * body->start;
        tip->velocity += m * tip_mean(body, body->velocity, 1);
        tip->force += tip_force(body, 1);
    }
    for (int c = 0; c < 3; c++)
        tip->position[c] /= tip->weight;
    tip->velocity /= tip->weight;
}

void wb_bundle_part_tip(const struct wb_bundle_part *part, double position[3])
{
    struct tip tip;

    look_at_tip(&part->bodies, &tip);
    memcpy(position, tip.position, sizeof tip.position);
}

/* Fifth-order smooth step: rest, speed and acceleration zero at both ends. */
static double smooth(double t)
{
    if (t <= 0.0)
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

double wb_bundle_part_target(const struct wb_bundle_part *part, double time)
{
    const struct wb_bundle_tip_path *tip_path = &part->tip_path;
    return tip_path->from +
           (tip_path->to - tip_path->from) * smooth((time - tip_path->start) / tip_path->duration);
}

/* Computes the force that moves the tip's mean height to its target in this step. A strand inclines
 * as the tip moves towards the clamp, and only pulls. */
static enum wb_status drive_tip(struct wb_bundle_part *part, double half)
{
    const double least_upright = 0.1;
    struct wb_bundle_bodies *bodies = &part->bodies;
    struct wb_bundle_account *account = &part->account;
    const struct wb_bundle_model *model = bodies->model;
    const double dt = bodies->time_step, length = model->loads.strand_length;
    struct tip tip;
    double lean[2] = {0.0, 0.0}, upright = 1.0;

    if (part->tip_path.tip_is_free) {
        account->slack = true;
        account->tension = account->vertical = 0.0;
        memset(account->pull, 0, sizeof account->pull);
        return WB_OK;
    }
    look_at_tip(bodies, &tip);
    const double wanted =
        (wb_bundle_part_target(part, part->clock.time + dt) - tip.position[1]) / dt;
    const double gravity = bodies->gravity / model->run.mass_scaling;
    const double vertical =
        tip.mass * ((wanted - tip.velocity) / (half * dt) + gravity) - tip.force;
    if (length > 0.0) {
        lean[0] = (model->length - tip.position[0]) / length;
        lean[1] = -tip.position[2] / length;
        upright = sqrt(fmax(0.0, 1.0 - lean[0] * lean[0] - lean[1] * lean[1]));
        if (upright < least_upright)
            return wb_fail_to(
                &part->reason, WB_ERR_DATA,
                "%s: the run failed after %lld steps: the tip is %.3g mm away from the vertical "
                "below the strand's upper end; strand length %.3g mm is too short",
                model->path, part->clock.steps, hypot(lean[0], lean[1]) * length / WB_MM,
                length / WB_MM);
    }
    account->slack = length > 0.0 && vertical < 0.0;
    account->vertical = account->slack ? 0.0 : vertical;
    account->tension = account->vertical / upright;

    account->pull[0] = account->tension * lean[0];
    account->pull[1] = account->vertical;
    account->pull[2] = account->tension * lean[1];
    for (int w = 0; w < bodies->n_wires; w++)
        distribute_tip_force(&bodies->wire[w], account->pull, tip.weight);
    if (bodies->has_tape)
        distribute_tip_force(&bodies->ring, account->pull, tip.weight);
    return WB_OK;
}

static void count_tip_work(struct wb_bundle_part *part, const struct tip *before)
{
    struct wb_bundle_account *account = &part->account;
    struct tip after;

    look_at_tip(&part->bodies, &after);
    account->tip_work += account->vertical * (after.position[1] - before->position[1]);
    account->tip_work += account->pull[0] * (after.position[0] - before->position[0]) +
                         account->pull[2] * (after.position[2] - before->position[2]);
}

/* --- a step --- */

/* Only element forces act on nodes inside a section, which need no clearing. */
static void clear_outline(struct wb_bundle_bodies *bodies, int w)
{
    struct wb_bundle_body *body = &bodies->wire[w];
    const size_t size = wb_swept_kernel_real_size(body->is_double);
    const int first = wb_swept_hex_first_added(bodies->type[bodies->model->type_of[w]].hex);
    const size_t inside = 3 * (size_t)first * (size_t)body->layout.stride;

    memset((unsigned char *)body->force + inside * size, 0,
           (wb_swept_size(&body->layout) - inside) * size);
}

/* Forces of everything but the wires' elements, which advance_wire() adds. */
static enum wb_status find_forces(struct wb_bundle_part *part, bool look)
{
    struct wb_bundle_bodies *bodies = &part->bodies;
    struct wb_bundle_account *account = &part->account;

    account->shells = (struct wb_swept_tape_sums){0};
    for (int w = 0; w < bodies->n_wires; w++)
        clear_outline(bodies, w);
    if (bodies->has_tape) {
        const struct wb_swept_tape_fields fields = {
            .position = bodies->ring.position,
            .director = bodies->directors.position,
            .force = bodies->ring.force,
            .moment = bodies->directors.force,
        };
        wb_swept_tape_forces(bodies->tape_state, &fields, 0, wb_swept_tape_blocks(bodies->tape),
                             look ? &account->shells : NULL);
    }
    if (part->contact) {
        WB_TRY(wb_swept_contact_add_forces(part->contact, bodies->positions, bodies->forces,
                                           bodies->time_step, &account->touching));
        account->friction_work += account->touching.friction;
    }
    if (part->bond) {
        WB_TRY(wb_bundle_bond_add_forces(part->bond, &account->bonded));
        account->damage_work += account->bonded.dissipated;
        account->friction_work += account->bonded.friction;
    }
    return WB_OK;
}

/* Blocks of the part's own stations. */
static struct wb_swept_range own_blocks(const struct wb_bundle_bodies *bodies)
{
    const struct wb_swept_range own = bodies->extent.own;
    return (struct wb_swept_range){own.first / WB_SWEPT_LANES,
                                   (own.end + WB_SWEPT_LANES - 1) / WB_SWEPT_LANES};
}

static void update(const struct wb_bundle_bodies *bodies, struct wb_bundle_body *body, double half,
                   struct wb_swept_range blocks, struct wb_swept_step_sums *sums)
{
    const struct wb_swept_step_fields fields = {body->position, body->velocity, body->force};
    const double times[2] = {half * bodies->time_step, bodies->time_step};

    wb_swept_step_update(body->step, &fields, times, blocks.first, blocks.end, sums);
}

/* Computes the elements' forces of one wire and makes its step, block by block, while each block is
 * in the cache. Blocks from `last` on wait for the tip's force. */
static void advance_wire(struct wb_bundle_part *part, int w, double half, int last, bool look,
                         struct wb_swept_step_sums *sums)
{
    struct wb_bundle_bodies *bodies = &part->bodies;
    struct wb_bundle_body *body = &bodies->wire[w];
    const struct wb_swept_range own = own_blocks(bodies);
    const int n = wb_swept_hex_blocks(bodies->type[bodies->model->type_of[w]].hex);
    const struct wb_swept_hex_fields fields = {body->position, body->force,
                                               bodies->is_large ? body->velocity : NULL};

    for (int b = 0; b < n; b++) {
        wb_swept_hex_add_forces(bodies->wire_state[w], &fields, b, b + 1,
                                look ? &part->account.wires : NULL);
        if (b >= own.first && b < own.end && b < last)
            update(bodies, body, half, (struct wb_swept_range){b, b + 1}, sums);
    }
}

enum wb_status wb_bundle_part_step(struct wb_bundle_part *part, bool look)
{
    struct wb_bundle_bodies *bodies = &part->bodies;
    struct wb_bundle_account *account = &part->account;
    const double half = part->clock.has_moved ? 1.0 : 0.5;
    const struct wb_swept_range own = own_blocks(bodies);
    const bool has_tip = wb_bundle_bodies_have_tip(bodies);
    const int last = has_tip ? own.end - 1 : own.end;
    struct wb_swept_step_sums sums = {0}, *wanted = look ? &sums : NULL;
    struct tip before = {0};

    WB_TRY(find_forces(part, look));
    account->wires = (struct wb_swept_hex_sums){0};
    for (int w = 0; w < bodies->n_wires; w++)
        advance_wire(part, w, half, last, look, wanted);
    if (has_tip) {
        look_at_tip(bodies, &before);
        WB_TRY(drive_tip(part, half));
    }
    if (part->cap)
        wb_bundle_cap_advance(part->cap, half);
    for (int w = 0; w < bodies->n_wires; w++)
        update(bodies, &bodies->wire[w], half, (struct wb_swept_range){last, own.end}, wanted);
    if (bodies->has_tape) {
        update(bodies, &bodies->ring, half, own, wanted);
        update(bodies, &bodies->directors, half, own, wanted);
    }
    part->clock.has_moved = true;
    if (look)
        account->kinetic = sums.kinetic + (part->cap ? wb_bundle_cap_kinetic(part->cap) : 0.0);
    part->clock.time += bodies->time_step;
    part->clock.steps++;

    if (has_tip)
        count_tip_work(part, &before);
    return isfinite(account->vertical)
               ? WB_OK
               : wb_fail_to(&part->reason, WB_ERR_DATA,
                            "%s: the run failed after %lld steps: the tip's force is not finite",
                            bodies->model->path, part->clock.steps);
}

void wb_bundle_part_stop(struct wb_bundle_part *part)
{
    wb_bundle_bodies_stop(&part->bodies);
    if (part->cap)
        wb_bundle_cap_stop(part->cap);
    part->clock.has_moved = false;
}

/* --- checkpoints --- */

void wb_bundle_part_visit_fields(struct wb_bundle_part *part, struct wb_checkpoint *checkpoint)
{
    wb_bundle_bodies_visit(&part->bodies, checkpoint);
    if (part->contact)
        wb_swept_contact_visit(part->contact, checkpoint);
    if (part->bond)
        wb_bundle_bond_visit(part->bond, checkpoint);
    if (part->cap)
        wb_bundle_cap_visit(part->cap, checkpoint);
}
