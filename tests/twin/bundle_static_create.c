#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/units.h"
#include "tests/twin/bundle_static_private.h"

#define WB_LOG_DOMAIN "bundle_static"

enum {
    USUAL_ELEMENTS = 80,
    MOST_ELEMENTS = 2000
};

static const double usual_tolerance = 1e-7, smallest_force = 1e-9;

static enum wb_status make_types(struct wb_bundle_static *b)
{
    for (int t = 0; t < b->model->n_types; t++) {
        const struct wb_wire *wire = &b->model->type[t];
        struct wb_section section;
        WB_TRY(wb_section_init_circle(&section, wire->outer_diameter, &wire->material,
                                      b->settings.n_fibres));
        const enum wb_status status = wb_fibres_create(&b->fibres[t], &section);
        wb_section_release(&section);
        WB_TRY(status);
        b->row[t] = wb_fibres_history_size(b->fibres[t]);
    }
    return WB_OK;
}

/* The wire at -z of each, and which of both leads. */
static enum wb_status mirror_wires(struct wb_bundle_static *b)
{
    for (int w = 0; w < b->n_wires; w++) {
        struct wb_bundle_static_beam *wire = &b->wire[w];
        const double near = 1e-6 * wire->radius;
        wire->mirror = -1;
        for (int i = 0; i < b->n_wires; i++)
            if (b->wire[i].type == wire->type && fabs(b->wire[i].y - wire->y) < near &&
                fabs(b->wire[i].z + wire->z) < near)
                wire->mirror = i;
        if (wire->mirror < 0)
            return wb_fail(WB_ERR_UNSUPPORTED,
                           "%s: wire %d, at y %.3f mm, z %.3f mm, has no mirror image at -z; the "
                           "static model needs a section that is symmetric to the plane of bending",
                           b->model->path, w + 1, wire->y * 1e3, wire->z * 1e3);
        wire->leads = wire->mirror >= w;
    }
    return WB_OK;
}

static enum wb_status make_wires(struct wb_bundle_static *b)
{
    double mass = 0.0;

    b->wire = calloc((size_t)b->n_wires, sizeof *b->wire);
    b->history_at = calloc((size_t)b->n_wires, sizeof *b->history_at);
    if (!b->wire || !b->history_at)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the wires");
    for (int w = 0; w < b->n_wires; w++) {
        const int type = b->model->type_of[w];
        const struct wb_wire *wire = &b->model->type[type];
        b->wire[w] = (struct wb_bundle_static_beam){
            .y = b->model->packing.wire[w].y,
            .z = b->model->packing.wire[w].z,
            .radius = 0.5 * wire->outer_diameter,
            .mass = wb_wire_mass_per_length(wire),
            .youngs_modulus = wire->material.youngs_modulus,
            .lateral = wb_fibres_bending_stiffness(b->fibres[type]),
            .type = type,
        };
        b->history_at[w] = b->history_size;
        b->history_size += b->row[type] * (size_t)b->n_elements;
        mass += b->wire[w].mass;
    }
    for (int w = 0; w < b->n_wires; w++)
        b->wire[w].share = b->wire[w].mass / mass;
    return mirror_wires(b);
}

/* Numbers of the unknowns in a station's block: originals first, then their images. */
static void number_unknowns(struct wb_bundle_static *b)
{
    for (int w = 0; w < b->n_wires; w++) {
        struct wb_bundle_static_beam *wire = &b->wire[w];
        wire->sign = wire->leads ? 1.0 : -1.0;
        for (int i = 0; i < WB_BUNDLE_STATIC_WIRE && wire->leads; i++)
            wire->unknown[i] = i == 2 && wire->mirror == w ? -1 : b->block++;
    }
    for (int k = 0; k < b->n_lines; k++) {
        struct wb_bundle_static_line *line = &b->line[k];
        line->sign = line->leads ? 1.0 : -1.0;
        for (int i = 0; i < WB_BUNDLE_STATIC_RING && line->leads; i++)
            line->unknown[i] = i == 2 && line->mirror == k ? -1 : b->block++;
    }
    for (int w = 0; w < b->n_wires; w++)
        for (int i = 0; i < WB_BUNDLE_STATIC_WIRE && !b->wire[w].leads; i++)
            b->wire[w].unknown[i] = b->wire[b->wire[w].mirror].unknown[i];
    for (int k = 0; k < b->n_lines; k++)
        for (int i = 0; i < WB_BUNDLE_STATIC_RING && !b->line[k].leads; i++)
            b->line[k].unknown[i] = b->line[b->line[k].mirror].unknown[i];
    b->n_unknowns = b->block * (b->n_stations - 1 - b->held);
}

static enum wb_status make_memory(struct wb_bundle_static *b)
{
    const size_t n = (size_t)b->n_unknowns, wires = (size_t)b->n_wires;
    const size_t stations = (size_t)b->n_stations, elements = (size_t)b->n_elements;

    b->strain_at = wires * WB_BUNDLE_STATIC_WIRE * stations;
    b->ring_at = b->strain_at + wires * 2 * elements;
    b->force_at = b->ring_at + (size_t)b->n_lines * WB_BUNDLE_STATIC_RING * stations;
    b->weight_at = b->force_at + 1;
    b->state_size = b->weight_at + 1;
    b->trial = calloc(b->state_size, sizeof *b->trial);
    b->committed = calloc(b->state_size, sizeof *b->committed);
    b->earlier = calloc(b->state_size, sizeof *b->earlier);
    b->saved = calloc(b->state_size, sizeof *b->saved);
    b->history = calloc(b->history_size + 1, sizeof *b->history);
    b->trial_history = calloc(b->history_size + 1, sizeof *b->trial_history);
    b->element = calloc(wires * elements, sizeof *b->element);
    b->committed_element = calloc(wires * elements, sizeof *b->committed_element);
    b->residual = calloc(n, sizeof *b->residual);
    b->push = calloc(n, sizeof *b->push);
    b->solution = calloc(2 * n, sizeof *b->solution);
    b->per_unit = calloc((size_t)b->block, sizeof *b->per_unit);
    b->pivot = calloc(n, sizeof *b->pivot);
    if (!b->trial || !b->committed || !b->earlier || !b->saved || !b->history ||
        !b->trial_history || !b->element || !b->committed_element || !b->residual || !b->push ||
        !b->solution || !b->per_unit || !b->pivot)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a bundle of %d wires", b->n_wires);
    return WB_OK;
}

/* The force that makes contact's round-off, which positions of the bundle's size have, as small as
 * residuals have to be. */
static void find_smallest_force(struct wb_bundle_static *b)
{
    double stiffest = 0.0;

    for (int p = 0; p < b->n_pairs; p++)
        stiffest = fmax(stiffest, b->pair[p].normal);
    b->smallest_force =
        8.0 * DBL_EPSILON * b->model->length * stiffest * b->h / b->settings.force_tolerance;
    b->smallest_force = fmax(b->smallest_force, smallest_force);
}

static enum wb_status build(struct wb_bundle_static *b)
{
    WB_TRY(make_types(b));
    WB_TRY(make_wires(b));
    WB_TRY(wb_bundle_static_make_contact(b));
    WB_TRY(wb_bundle_static_make_tape(b));
    number_unknowns(b);
    find_smallest_force(b);
    WB_TRY(make_memory(b));
    for (int i = 0; i < b->block; i++)
        b->per_unit[i] = 1.0;
    for (int w = 0; w < b->n_wires; w++)
        b->per_unit[b->wire[w].unknown[3]] = 1.0 / b->model->length;
    for (int w = 0; w < b->n_wires; w++)
        for (int j = 0; j < b->n_stations; j++) {
            wb_bundle_static_wire_field(b, b->trial, w, 0)[j] = j * b->h;
            wb_bundle_static_wire_field(b, b->trial, w, 1)[j] = b->wire[w].y;
            wb_bundle_static_wire_field(b, b->trial, w, 2)[j] = b->wire[w].z;
        }
    for (size_t i = 0; i < b->state_size; i++)
        b->committed[i] = b->earlier[i] = b->trial[i];
    b->last.tip_x = b->model->length;
    return WB_OK;
}

static enum wb_status check(const struct wb_bundle_model *model,
                            const struct wb_bundle_static_settings *settings)
{
    if (model->tip == WB_BUNDLE_TIP_CAPPED)
        return wb_fail(WB_ERR_UNSUPPORTED, "%s: the static model has no capped tip; use tip: free",
                       model->path);
    if (settings->n_elements < 0 || settings->n_elements > MOST_ELEMENTS)
        return wb_fail(WB_ERR_ARGUMENT, "%d elements: expected 1 to %d, or 0", settings->n_elements,
                       MOST_ELEMENTS);
    if (settings->arc_nodes < 0 || settings->arc_nodes == 1)
        return wb_fail(WB_ERR_ARGUMENT, "%d nodes on an arc: expected 2 or more, or 0",
                       settings->arc_nodes);
    return WB_OK;
}

enum wb_status wb_bundle_static_create(struct wb_bundle_static **out,
                                       const struct wb_bundle_model *model,
                                       const struct wb_bundle_static_settings *settings)
{
    static const struct wb_bundle_static_settings usual;

    *out = NULL;
    if (!settings)
        settings = &usual;
    WB_TRY(check(model, settings));
    struct wb_bundle_static *b = calloc(1, sizeof *b);
    if (!b)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a bundle");
    b->model = model;
    b->settings = *settings;
    if (!(b->settings.force_tolerance > 0.0))
        b->settings.force_tolerance = usual_tolerance;
    b->n_elements = settings->n_elements > 0 ? settings->n_elements : USUAL_ELEMENTS;
    b->n_stations = b->n_elements + 1;
    b->h = model->length / b->n_elements;
    b->held = (int)floor(model->potted_length / b->h + 1e-9);
    b->n_wires = model->packing.n;
    b->gravity = model->loads.weight ? WB_STANDARD_GRAVITY : 0.0;

    enum wb_status status = WB_OK;
    if (b->held >= b->n_elements)
        status = wb_fail(WB_ERR_ARGUMENT, "%s: all of the length is potted", model->path);
    if (status == WB_OK)
        status = build(b);
    if (status != WB_OK)
        wb_bundle_static_destroy(b);
    else
        *out = b;
    return status;
}

void wb_bundle_static_destroy(struct wb_bundle_static *b)
{
    if (!b)
        return;
    for (int t = 0; t < WB_BUNDLE_MODEL_TYPES; t++)
        wb_fibres_destroy(b->fibres[t]);
    for (int p = 0; p < b->n_pairs; p++)
        free(b->pair[p].touch);
    free(b->pair);
    free(b->line);
    free(b->point);
    free(b->trial_point);
    free(b->wire);
    free(b->history_at);
    free(b->history);
    free(b->trial_history);
    free(b->trial);
    free(b->committed);
    free(b->earlier);
    free(b->saved);
    free(b->element);
    free(b->committed_element);
    free(b->matrix);
    free(b->residual);
    free(b->push);
    free(b->solution);
    free(b->per_unit);
    free(b->pivot);
    free(b);
}

int wb_bundle_static_unknowns(const struct wb_bundle_static *b)
{
    return b->n_unknowns;
}
