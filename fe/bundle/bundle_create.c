#include <math.h>
#include <stdlib.h>

#include "base/units.h"
#include "fe/bundle/bundle_private.h"
#include "fe/bundle/bundle_tape.h"
#include "fe/swept/swept_frequency.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

/* Of the stable step's bound, which is that of the straight, stress-free bundle. */
static const double usual_safety = 0.9;

/* --- wires --- */

static enum wb_swept_hex_formulation formulation_of(const struct wb_bundle_mesh *mesh)
{
    return mesh->formulation == WB_BUNDLE_ONE_POINT ? WB_SWEPT_HEX_ONE_POINT
                                                    : WB_SWEPT_HEX_FOUR_POINTS;
}

/* The section's area errs where its second moment is fitted; mass is the wire's own. */
static enum wb_status share_mass(struct wb_bundle_type *type, const struct wb_wire *wire)
{
    const double mass = wb_wire_mass_per_length(wire);

    type->node_mass = calloc((size_t)type->section.n_nodes, sizeof *type->node_mass);
    if (!type->node_mass)
        return wb_fail(WB_ERR_MEMORY, "out of memory for masses");
    for (int k = 0; k < type->section.n_nodes; k++)
        type->node_mass[k] = mass * type->section.share[k];
    return WB_OK;
}

enum wb_status wb_bundle_create_step(const struct wb_bundle *bundle, struct wb_swept_layout layout,
                                     const double *node_mass, double gravity,
                                     struct wb_swept_step **out)
{
    const struct wb_bundle_run *run = &bundle->model->run;
    const struct wb_swept_step_model model = {
        .layout = layout,
        .node_mass = node_mass,
        .spacing = bundle->spacing,
        .mass_scaling = run->mass_scaling,
        .selective = run->selective,
        .gravity = {0.0, -gravity, 0.0},
        .double_precision = run->double_precision,
    };
    return wb_swept_step_create(out, &model);
}

static enum wb_status make_type(struct wb_bundle *bundle, int t)
{
    const struct wb_wire *wire = &bundle->model->type[t];
    struct wb_bundle_type *type = &bundle->type[t];
    const enum wb_swept_hex_formulation formulation = formulation_of(bundle->mesh);

    WB_TRY(wb_swept_section_init_circle(&type->section, wire->outer_diameter,
                                        bundle->mesh->core_quads, bundle->mesh->rings));
    wb_swept_hex_fit_circle(&type->section, wire->outer_diameter, formulation, &wire->material);
    const struct wb_swept_hex_model model = {
        .section = &type->section,
        .material = wire->material,
        .n_elements = bundle->n_stations - 1,
        .element_length = bundle->spacing,
        .counted = bundle->own,
        .formulation = formulation,
        .double_precision = bundle->model->run.double_precision,
    };
    WB_TRY(wb_swept_hex_create(&type->hex, &model));
    WB_TRY(share_mass(type, wire));
    return wb_bundle_create_step(bundle, wb_swept_hex_layout(type->hex), type->node_mass,
                                 bundle->gravity, &type->step);
}

enum wb_status wb_bundle_create_fields(const struct wb_bundle *bundle, struct wb_bundle_body *body,
                                       struct wb_swept_layout layout)
{
    const size_t n = wb_swept_size(&layout);

    body->layout = layout;
    body->is_double = bundle->model->run.double_precision;
    WB_TRY(wb_swept_allocate((void **)&body->position, n, sizeof *body->position));
    WB_TRY(wb_swept_allocate((void **)&body->velocity, n, sizeof *body->velocity));
    return wb_swept_allocate(&body->force, n, wb_bundle_force_size(body));
}

/* A straight body: section points at every station, padding too. */
static void place(const struct wb_bundle *bundle, struct wb_bundle_body *body, int node, double y,
                  double z)
{
    for (int j = 0; j < body->layout.stride; j++) {
        const double at[3] = {(bundle->first + fmin(j, bundle->n_stations - 1)) * bundle->spacing,
                              y, z};
        for (int c = 0; c < 3; c++)
            body->position[(3 * node + c) * body->layout.stride + j] = at[c];
    }
}

static enum wb_status make_wire(struct wb_bundle *bundle, int w)
{
    const struct wb_packing_circle *circle = &bundle->model->packing.wire[w];
    struct wb_bundle_type *type = &bundle->type[bundle->model->type_of[w]];
    struct wb_bundle_body *body = &bundle->wire[w];

    WB_TRY(wb_swept_hex_state_create(&bundle->history[w], type->hex));
    WB_TRY(wb_bundle_create_fields(bundle, body, wb_swept_hex_layout(type->hex)));
    body->step = type->step;
    body->node_mass = type->node_mass;
    for (int k = 0; k < body->layout.n_nodes; k++) {
        const double *node = type->section.node[k];
        place(bundle, body, k, circle->y + node[0], circle->z + node[1]);
        body->mass += type->node_mass[k];
        body->start += type->node_mass[k] * (circle->y + node[0]);
    }
    body->start /= body->mass;
    bundle->positions[w] = body->position;
    bundle->forces[w] = body->force;
    return WB_OK;
}

static enum wb_status make_contact(struct wb_bundle *bundle)
{
    const struct wb_bundle_interface *interface = &bundle->model->interface;
    struct wb_swept_contact_wire wires[WB_PACKING_MOST];
    struct wb_swept_contact_settings settings;

    if (bundle->n_wires < 2)
        return WB_OK;
    wb_swept_contact_default_settings(&settings);
    settings.friction_static = interface->friction_static;
    settings.friction_kinetic = interface->friction_kinetic;
    settings.friction_decay = interface->friction_decay;
    settings.counted = bundle->own;
    settings.double_precision = bundle->model->run.double_precision;
    for (int w = 0; w < bundle->n_wires; w++) {
        const struct wb_bundle_type *type = &bundle->type[bundle->model->type_of[w]];
        const struct wb_wire *wire = &bundle->model->type[bundle->model->type_of[w]];
        wires[w] = (struct wb_swept_contact_wire){
            .n_nodes = type->section.n_nodes,
            .n_surface = type->section.n_outline,
            .surface = type->section.outline,
            .node = (const double(*)[2])type->section.node,
            .radius = 0.5 * wire->outer_diameter,
            .youngs_modulus = wire->material.youngs_modulus,
        };
    }
    return wb_swept_contact_create(&bundle->contact, &settings, bundle->n_wires, wires,
                                   bundle->n_stations, bundle->spacing);
}

/* --- ends and step --- */

/* What the clamp holds, and what belongs to other parts: their positions come from there. */
static void hold_stations(struct wb_bundle *bundle)
{
    const int last = wb_bundle_last_held(bundle) - bundle->first;

    for (int j = 0; j < bundle->n_stations; j++)
        for (int c = 0; c < 3 && (j <= last || j < bundle->own.first || j >= bundle->own.end);
             c++) {
            for (int t = 0; t < bundle->model->n_types; t++)
                wb_swept_step_hold(bundle->type[t].step, j, c, true);
            if (bundle->has_tape) {
                wb_swept_step_hold(bundle->tape_step, j, c, true);
                wb_swept_step_hold(bundle->director_step, j, c, true);
            }
        }
}

static enum wb_status find_time_step(struct wb_bundle *bundle)
{
    const struct wb_bundle_run *run = &bundle->model->run;
    double largest = 0.0; /* omega^2 with f_m */

    for (int w = 0; w < bundle->n_wires; w++) {
        const struct wb_bundle_type *type = &bundle->type[bundle->model->type_of[w]];
        const int n = type->section.n_nodes;
        double omega, added = 0.0;
        double *mass = calloc((size_t)n, sizeof *mass);
        if (!mass)
            return wb_fail(WB_ERR_MEMORY, "out of memory for masses");
        for (int k = 0; k < n; k++)
            mass[k] = type->node_mass[k] * bundle->spacing * run->mass_scaling;
        const enum wb_status status =
            wb_swept_frequency_bound(type->hex, type->node_mass, run->selective, &omega);
        if (status == WB_OK && bundle->contact)
            added = wb_swept_contact_stiffness_per_mass(bundle->contact, w, type->node_mass,
                                                        run->selective) /
                    run->mass_scaling;
        if (status == WB_OK && bundle->bond)
            added += wb_bundle_bond_wire_stiffness(bundle->bond, w, mass);
        free(mass);
        if (status != WB_OK)
            return status;
        largest = fmax(largest, omega * omega / run->mass_scaling + added);
    }
    if (bundle->has_tape) {
        double tape;
        WB_TRY(wb_swept_tape_stiffness_per_mass(bundle->tape, &tape));
        largest =
            fmax(largest, tape / run->mass_scaling + wb_bundle_bond_ring_stiffness(bundle->bond));
    }
    const double safety =
        bundle->settings.step_safety > 0.0 ? bundle->settings.step_safety : usual_safety;
    bundle->time_step = safety * 2.0 / sqrt(largest);
    return isfinite(bundle->time_step) && bundle->time_step > 0.0
               ? WB_OK
               : wb_fail(WB_ERR_ARGUMENT, "%s: there is no stable time step", bundle->model->path);
}

/* Smaller ones gain nothing by fetching ahead: seven wires of the engineering mesh, 0.7 MB, lose
 * 3 %. */
static bool is_large(const struct wb_bundle *bundle)
{
    const size_t near = 4u << 20; /* bytes */
    size_t bytes = 0;

    for (int w = 0; w < bundle->n_wires; w++)
        bytes += wb_swept_size(&bundle->wire[w].layout) *
                 (2 * sizeof(double) + wb_bundle_force_size(&bundle->wire[w]));
    return bytes > near;
}

static enum wb_status build(struct wb_bundle *bundle)
{
    for (int t = 0; t < bundle->model->n_types; t++)
        WB_TRY(make_type(bundle, t));
    for (int w = 0; w < bundle->n_wires; w++)
        WB_TRY(make_wire(bundle, w));
    bundle->is_large = is_large(bundle);
    WB_TRY(make_contact(bundle));
    if (bundle->model->has_tape)
        WB_TRY(wb_bundle_tape_create(bundle));
    hold_stations(bundle);
    /* Not where it is only in the halo. */
    if (bundle->model->tip == WB_BUNDLE_TIP_CAPPED &&
        bundle->first + bundle->own.end == bundle->n_whole)
        WB_TRY(wb_bundle_cap_create(&bundle->cap, bundle));
    if (!bundle->whole)
        return find_time_step(bundle);
    bundle->time_step = bundle->whole->time_step;
    return WB_OK;
}

enum wb_status wb_bundle_create(struct wb_bundle **out, const struct wb_bundle_model *model,
                                const struct wb_bundle_settings *settings)
{
    *out = NULL;
    const char *name = settings->mesh ? settings->mesh : model->run.mesh;
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(model, name);
    if (!mesh)
        return wb_fail(WB_ERR_NOT_FOUND, "%s: there is no mesh '%s'", model->path, name);
    if (!(settings->duration > 0.0 && isfinite(settings->duration)))
        return wb_fail(WB_ERR_ARGUMENT, "a duration of %g s: expected above 0", settings->duration);

    struct wb_bundle *bundle = calloc(1, sizeof *bundle);
    if (!bundle)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a bundle");
    bundle->model = model;
    bundle->mesh = mesh;
    bundle->settings = *settings;
    bundle->n_wires = model->packing.n;
    bundle->n_stations = bundle->n_whole = mesh->elements_along + 1;
    bundle->own = (struct wb_swept_range){0, bundle->n_stations};
    bundle->spacing = model->length / mesh->elements_along;
    bundle->way_duration = settings->duration;
    bundle->gravity = model->loads.weight ? WB_STANDARD_GRAVITY : 0.0;

    const int parts = wb_bundle_parts_of(model, name, settings->threads);
    enum wb_status status = wb_team_agree(build(bundle));
    if (status == WB_OK && parts > 1)
        status = wb_bundle_parts_create(&bundle->parts, bundle, parts);
    if (status != WB_OK)
        wb_bundle_destroy(bundle);
    else
        *out = bundle;
    return status;
}

enum wb_status wb_bundle_create_part(struct wb_bundle **out, const struct wb_bundle *whole,
                                     int first, int n_stations, struct wb_swept_range own)
{
    *out = NULL;
    struct wb_bundle *bundle = calloc(1, sizeof *bundle);
    if (!bundle)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a part of a bundle");
    bundle->model = whole->model;
    bundle->mesh = whole->mesh;
    bundle->settings = whole->settings;
    bundle->whole = whole;
    bundle->first = first;
    bundle->n_stations = n_stations;
    bundle->n_whole = whole->n_whole;
    bundle->own = own;
    bundle->n_wires = whole->n_wires;
    bundle->spacing = whole->spacing;
    bundle->way_duration = whole->way_duration;
    bundle->gravity = whole->gravity;

    const enum wb_status status = build(bundle);
    if (status != WB_OK)
        wb_bundle_destroy(bundle);
    else
        *out = bundle;
    return status;
}

static void release_body(struct wb_bundle_body *body)
{
    free(body->position);
    free(body->velocity);
    free(body->force);
}

void wb_bundle_destroy(struct wb_bundle *bundle)
{
    if (!bundle)
        return;
    wb_bundle_parts_destroy(bundle->parts);
    wb_bundle_cap_destroy(bundle->cap);
    wb_bundle_tape_release(bundle);
    wb_swept_contact_destroy(bundle->contact);
    for (int w = 0; w < bundle->n_wires; w++) {
        wb_swept_hex_state_destroy(bundle->history[w]);
        release_body(&bundle->wire[w]);
    }
    for (int t = 0; t < bundle->model->n_types; t++) {
        wb_swept_step_destroy(bundle->type[t].step);
        wb_swept_hex_destroy(bundle->type[t].hex);
        free(bundle->type[t].node_mass);
        wb_swept_section_release(&bundle->type[t].section);
    }
    release_body(&bundle->ring);
    release_body(&bundle->directors);
    free(bundle);
}
