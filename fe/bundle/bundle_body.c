#include "fe/bundle/bundle_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"

/* --- one body --- */

double wb_bundle_body_force(const struct wb_bundle_body *body, size_t at)
{
    return wb_swept_kernel_get(body->is_double, body->force, (ptrdiff_t)at);
}

void wb_bundle_body_add_force(struct wb_bundle_body *body, size_t at, double force)
{
    if (body->is_double)
        ((double *)body->force)[at] += force;
    else
        ((float *)body->force)[at] += (float)force;
}

static void visit_body(struct wb_bundle_body *body, struct wb_checkpoint *checkpoint)
{
    const size_t n = wb_swept_size(&body->layout);

    wb_checkpoint_visit(checkpoint, "position", body->position, n * sizeof *body->position);
    wb_checkpoint_visit(checkpoint, "velocity", body->velocity, n * sizeof *body->velocity);
    wb_checkpoint_visit(checkpoint, "force", body->force,
                        n * wb_swept_kernel_real_size(body->is_double));
}

/* --- creation --- */

static enum wb_swept_hex_formulation formulation_of(const struct wb_bundle_mesh *mesh)
{
    return mesh->formulation == WB_BUNDLE_ONE_POINT ? WB_SWEPT_HEX_ONE_POINT
                                                    : WB_SWEPT_HEX_FOUR_POINTS;
}

/* Masses use the wire's own area: that of the section's mesh differs, because its second moment is
 * fitted. */
static void share_mass(struct wb_memory *memory, struct wb_bundle_type *type,
                       const struct wb_wire *wire)
{
    const double mass = wb_wire_mass_per_length(wire);
    type->node_mass = wb_memory_take(memory, (size_t)type->section.n_nodes, sizeof(double));
    for (int k = 0; k < type->section.n_nodes; k++)
        type->node_mass[k] = mass * type->section.share[k];
}

enum wb_status wb_bundle_bodies_create_step(const struct wb_bundle_bodies *bodies,
                                            struct wb_swept_layout layout, const double *node_mass,
                                            double gravity, struct wb_swept_step **out)
{
    const struct wb_bundle_run *run = &bodies->model->run;
    const struct wb_swept_step_model model = {
        .layout = layout,
        .node_mass = node_mass,
        .spacing = bodies->spacing,
        .mass_scaling = run->mass_scaling,
        .selective = run->selective,
        .gravity = {0.0, -gravity, 0.0},
        .double_precision = run->double_precision,
    };
    return wb_swept_step_create(out, &model);
}

static enum wb_status make_type(struct wb_bundle_bodies *bodies, int t)
{
    const struct wb_wire *wire = &bodies->model->type[t];
    struct wb_bundle_type *type = &bodies->type[t];
    const enum wb_swept_hex_formulation formulation = formulation_of(bodies->mesh);

    WB_TRY(wb_swept_section_init_circle(&type->section, wire->outer_diameter,
                                        bodies->mesh->core_quads, bodies->mesh->rings));
    wb_swept_hex_fit_circle(&type->section, wire->outer_diameter, formulation, &wire->material);
    const struct wb_swept_hex_model model = {
        .section = &type->section,
        .material = wire->material,
        .n_elements = bodies->extent.n_stations - 1,
        .element_length = bodies->spacing,
        .counted = bodies->extent.own,
        .formulation = formulation,
        .double_precision = bodies->model->run.double_precision,
    };
    WB_TRY(wb_swept_hex_create(&type->hex, &model));
    share_mass(&bodies->memory, type, wire);
    return wb_bundle_bodies_create_step(bodies, wb_swept_hex_layout(type->hex), type->node_mass,
                                        bodies->gravity, &type->step);
}

void wb_bundle_bodies_create_fields(struct wb_bundle_bodies *bodies, struct wb_bundle_body *body,
                                    struct wb_swept_layout layout)
{
    const size_t n = wb_swept_size(&layout);

    body->layout = layout;
    body->is_double = bodies->model->run.double_precision;
    body->position = wb_swept_take(&bodies->memory, n, sizeof *body->position);
    body->velocity = wb_swept_take(&bodies->memory, n, sizeof *body->velocity);
    body->force = wb_swept_take(&bodies->memory, n, wb_swept_kernel_real_size(body->is_double));
}

/* A straight body: positions of the section points at all stations, including padding. */
static void place(const struct wb_bundle_bodies *bodies, struct wb_bundle_body *body, int node,
                  double y, double z)
{
    const struct wb_bundle_extent *extent = &bodies->extent;

    for (int j = 0; j < body->layout.stride; j++) {
        const double at[3] = {(extent->first + fmin(j, extent->n_stations - 1)) * bodies->spacing,
                              y, z};
        for (int c = 0; c < 3; c++)
            body->position[(3 * node + c) * body->layout.stride + j] = at[c];
    }
}

static void make_wire(struct wb_bundle_bodies *bodies, int w)
{
    const struct wb_packing_circle *circle = &bodies->model->packing.wire[w];
    struct wb_bundle_type *type = &bodies->type[bodies->model->type_of[w]];
    struct wb_bundle_body *body = &bodies->wire[w];

    bodies->wire_state[w] = wb_swept_hex_state_create(type->hex);
    wb_bundle_bodies_create_fields(bodies, body, wb_swept_hex_layout(type->hex));
    body->step = type->step;
    body->node_mass = type->node_mass;
    for (int k = 0; k < body->layout.n_nodes; k++) {
        const double *node = type->section.node[k];
        place(bodies, body, k, circle->y + node[0], circle->z + node[1]);
        body->mass += type->node_mass[k];
        body->start += type->node_mass[k] * (circle->y + node[0]);
    }
    body->start /= body->mass;
    bodies->positions[w] = body->position;
    bodies->forces[w] = body->force;
}

/* Prefetching helps only large bodies: seven wires of the engineering mesh, 0.7 MB, become 3 %
 * slower. */
static bool is_large(const struct wb_bundle_bodies *bodies)
{
    const size_t near = 4u << 20; /* bytes */
    size_t bytes = 0;

    for (int w = 0; w < bodies->n_wires; w++)
        bytes += wb_swept_size(&bodies->wire[w].layout) *
                 (2 * sizeof(double) + wb_swept_kernel_real_size(bodies->wire[w].is_double));
    return bytes > near;
}

enum wb_status wb_bundle_bodies_init(struct wb_bundle_bodies *bodies,
                                     const struct wb_bundle_model *model,
                                     const struct wb_bundle_mesh *mesh,
                                     const struct wb_bundle_extent *extent)
{
    *bodies = (struct wb_bundle_bodies){
        .model = model,
        .mesh = mesh,
        .extent = *extent,
        .spacing = model->length / mesh->elements_along,
        .gravity = model->loads.weight ? WB_STANDARD_GRAVITY : 0.0,
        .n_wires = model->packing.n,
    };
    for (int t = 0; t < model->n_types; t++)
        WB_TRY(make_type(bodies, t));
    for (int w = 0; w < bodies->n_wires; w++)
        make_wire(bodies, w);
    bodies->is_large = is_large(bodies);
    return WB_OK;
}

void wb_bundle_bodies_release(struct wb_bundle_bodies *bodies)
{
    for (int w = 0; w < bodies->n_wires; w++)
        wb_swept_hex_state_destroy(bodies->wire_state[w]);
    for (int t = 0; t < WB_BUNDLE_MODEL_TYPES; t++) {
        wb_swept_step_destroy(bodies->type[t].step);
        wb_swept_hex_destroy(bodies->type[t].hex);
        wb_swept_section_release(&bodies->type[t].section);
    }
    wb_swept_tape_state_destroy(bodies->tape_state);
    wb_swept_tape_destroy(bodies->tape);
    wb_swept_step_destroy(bodies->ring.step);
    wb_swept_step_destroy(bodies->directors.step);
    wb_memory_release(&bodies->memory);
    *bodies = (struct wb_bundle_bodies){0};
}

void wb_bundle_bodies_describe(const struct wb_bundle_bodies *bodies,
                               struct wb_swept_wire wires[WB_PACKING_MOST])
{
    const struct wb_bundle_model *model = bodies->model;

    for (int w = 0; w < bodies->n_wires; w++) {
        const struct wb_swept_section *section = &bodies->type[model->type_of[w]].section;
        const struct wb_wire *wire = &model->type[model->type_of[w]];
        wires[w] = (struct wb_swept_wire){
            .n_nodes = section->n_nodes,
            .n_surface = section->n_outline,
            .surface = section->outline,
            .node = (const double(*)[2])section->node,
            .y = model->packing.wire[w].y,
            .z = model->packing.wire[w].z,
            .radius = 0.5 * wire->outer_diameter,
            .youngs_modulus = wire->material.youngs_modulus,
        };
    }
}

void wb_bundle_bodies_hold(const struct wb_bundle_bodies *bodies, int station)
{
    for (int c = 0; c < 3; c++) {
        for (int t = 0; t < bodies->model->n_types; t++)
            wb_swept_step_hold(bodies->type[t].step, station, c, true);
        if (bodies->has_tape) {
            wb_swept_step_hold(bodies->ring.step, station, c, true);
            wb_swept_step_hold(bodies->directors.step, station, c, true);
        }
    }
}

/* --- all bodies --- */

int wb_bundle_bodies_list(struct wb_bundle_bodies *bodies,
                          struct wb_bundle_body *body[WB_BUNDLE_MOST_BODIES])
{
    int n = 0;

    for (int w = 0; w < bodies->n_wires; w++)
        body[n++] = &bodies->wire[w];
    if (bodies->has_tape) {
        body[n++] = &bodies->ring;
        body[n++] = &bodies->directors;
    }
    return n;
}

int wb_bundle_bodies_last_held(const struct wb_bundle_bodies *bodies)
{
    return (int)floor(bodies->model->potted_length / bodies->spacing + 1e-9);
}

bool wb_bundle_bodies_have_tip(const struct wb_bundle_bodies *bodies)
{
    return bodies->extent.first + bodies->extent.own.end == bodies->extent.n_whole;
}

double wb_bundle_bodies_station_mass(const struct wb_bundle_bodies *bodies,
                                     const struct wb_bundle_body *body, int station)
{
    const int in_whole = bodies->extent.first + station;
    const bool end = in_whole == 0 || in_whole == bodies->extent.n_whole - 1;
    return body->mass * bodies->spacing * (end ? 0.5 : 1.0) * bodies->model->run.mass_scaling;
}

void wb_bundle_bodies_stop(struct wb_bundle_bodies *bodies)
{
    struct wb_bundle_body *body[WB_BUNDLE_MOST_BODIES];
    const int n = wb_bundle_bodies_list(bodies, body);

    for (int b = 0; b < n; b++)
        memset(body[b]->velocity, 0, wb_swept_size(&body[b]->layout) * sizeof *body[b]->velocity);
}

/* A body's contribution to the weight's potential, J. */
static double potential_of(const struct wb_bundle_bodies *bodies, const struct wb_bundle_body *body)
{
    const struct wb_bundle_extent *extent = &bodies->extent;
    const int last = extent->n_whole - 1 - extent->first;
    double sum = 0.0;

    for (int k = 0; k < body->layout.n_nodes; k++) {
        const double *y = body->position + (ptrdiff_t)(3 * k + 1) * body->layout.stride;
        double heights = 0.0;
        for (int j = extent->own.first; j < extent->own.end; j++)
            heights += extent->first + j == 0 || j == last ? 0.5 * y[j] : y[j];
        sum += body->node_mass[k] * heights;
    }
    return sum * bodies->spacing * bodies->gravity;
}

double wb_bundle_bodies_potential(const struct wb_bundle_bodies *bodies)
{
    double sum = 0.0;

    for (int w = 0; w < bodies->n_wires; w++)
        sum += potential_of(bodies, &bodies->wire[w]);
    return sum + (bodies->has_tape ? potential_of(bodies, &bodies->ring) : 0.0);
}

double wb_bundle_bodies_plastic_work(const struct wb_bundle_bodies *bodies)
{
    double plastic = 0.0;

    for (int w = 0; w < bodies->n_wires; w++)
        plastic += wb_swept_hex_plastic_work(bodies->wire_state[w]);
    if (bodies->has_tape)
        plastic += wb_swept_tape_plastic_work(bodies->tape_state);
    return plastic;
}

void wb_bundle_bodies_visit(struct wb_bundle_bodies *bodies, struct wb_checkpoint *checkpoint)
{
    size_t bytes;
    void *data;

    for (int w = 0; w < bodies->n_wires; w++) {
        wb_checkpoint_enter(checkpoint, "wire %d", w + 1);
        visit_body(&bodies->wire[w], checkpoint);
        data = wb_swept_hex_state_data(bodies->wire_state[w], &bytes);
        wb_checkpoint_visit(checkpoint, "material", data, bytes);
        wb_checkpoint_leave(checkpoint);
    }
    if (!bodies->has_tape)
        return;
    wb_checkpoint_enter(checkpoint, "tape");
    visit_body(&bodies->ring, checkpoint);
    data = wb_swept_tape_state_data(bodies->tape_state, &bytes);
    wb_checkpoint_visit(checkpoint, "material", data, bytes);
    wb_checkpoint_leave(checkpoint);
    wb_checkpoint_enter(checkpoint, "directors");
    visit_body(&bodies->directors, checkpoint);
    wb_checkpoint_leave(checkpoint);
}
