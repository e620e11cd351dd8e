#include "fe/bundle/bundle_tape.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "bundle"

static const double max_turned = 1.0 / 12.0; /* maximum turns of a helix from station to station */
static const double max_missing_mass = 0.02; /* of a helix's mass */
static const double usual_turned =
    1.0 / 25.0; /* suggested turns from station to station if the mesh is too coarse */
static const double mass_order =
    1.3; /* exponent of the missing mass over the element length, found for the paper's bundles */

/* --- geometry --- */

/* Number of elements around the ring; a strip has one more node. */
static int elements_of(const struct wb_bundle_bodies *bodies)
{
    const int round = wb_bundle_model_tape_quads(bodies->model, bodies->mesh);
    const struct wb_taping *taping = &bodies->model->tape.taping;

    if (taping->kind == WB_TAPING_SLEEVE)
        return round;
    return (int)fmax(1.0, rint(taping->layers * round));
}

static double layer_thickness(const struct wb_taping *taping)
{
    return taping->kind == WB_TAPING_SLEEVE ? wb_taping_thickness(taping) : taping->layer_thickness;
}

/* Number of layers below: 0, 1 from one turn on, and so on; the tape climbs from layer to layer
 * within `ramp` turns. The end of the strip has no step. */
static double layers_below(double level, double layers, double ramp)
{
    double below = 0.0;

    for (int i = 1; i < layers - 1e-9; i++)
        below += fmin(fmax(0.5 + 0.5 * (level - i) / ramp, 0.0), 1.0);
    return below;
}

struct wb_bundle_tape_place wb_bundle_tape_place(const struct wb_bundle_bodies *bodies, double node,
                                                 int station)
{
    const struct wb_bundle_tape *tape = &bodies->model->tape;
    const struct wb_taping *taping = &tape->taping;
    const double middle = tape->gap + 0.5 * wb_taping_thickness(taping);
    const double around = wb_hull_length(&tape->hull, middle), part = node / elements_of(bodies);
    struct wb_bundle_tape_place place = {.is_tape = true};

    /* The outline runs from z towards y; a right-handed strip runs the opposite way along the
     * bundle. */
    if (taping->kind == WB_TAPING_SLEEVE) {
        place.point = wb_hull_at(&tape->hull, middle, around * part);
        return place;
    }
    const double along = (bodies->extent.first + station) * bodies->spacing;
    const double turned = -taping->helix.hand * along / taping->advance; /* turns */
    const double layers = taping->layers;
    place.point = wb_hull_at(&tape->hull, middle, around * (turned + layers * (part - 0.5)));
    place.level = layers * (taping->helix.hand < 0 ? part : 1.0 - part);
    place.is_tape = part >= 0.0 && part <= 1.0;
    const double ramp = fmin(layers / elements_of(bodies), 0.25);
    const double thickness = taping->layer_thickness;
    place.outside =
        tape->gap + thickness * (0.5 + layers_below(place.level, layers, ramp)) - middle;
    return place;
}

static void place_ring(struct wb_bundle_bodies *bodies)
{
    struct wb_bundle_body *ring = &bodies->ring;

    for (int k = 0; k < ring->layout.n_nodes; k++) {
        for (int j = 0; j < ring->layout.stride; j++) {
            const int station = j < bodies->extent.n_stations ? j : bodies->extent.n_stations - 1;
            const struct wb_bundle_tape_place at = wb_bundle_tape_place(bodies, k, station);
            const double x[3] = {(bodies->extent.first + station) * bodies->spacing,
                                 at.point.y + at.outside * sin(at.point.normal),
                                 at.point.z + at.outside * cos(at.point.normal)};
            for (int c = 0; c < 3; c++)
                ring->position[(3 * k + c) * ring->layout.stride + j] = x[c];
        }
    }
}

/* --- creation --- */

/* `needed`: elements along the bundle. */
static enum wb_status reject_mesh(const struct wb_bundle_bodies *bodies, double needed)
{
    return wb_fail(
        WB_ERR_ARGUMENT,
        "%s: mesh '%s' with %d elements along is too coarse for a helix with a lead of %.3g "
        "mm per turn: use a mesh with elements_along: %d or more",
        bodies->model->path, bodies->mesh->name, bodies->mesh->elements_along,
        bodies->model->tape.taping.advance / WB_MM, (int)ceil(needed));
}

/* Checked before the tape is created: elements with more rotation are not convex. */
static enum wb_status check_twist(const struct wb_bundle_bodies *bodies)
{
    const double turned = bodies->spacing / bodies->model->tape.taping.advance;

    if (turned <= max_turned)
        return WB_OK;
    return reject_mesh(bodies, bodies->mesh->elements_along * turned / usual_turned);
}

/* The strip's facets cut the outline's corners. */
static enum wb_status check_mass(const struct wb_bundle_bodies *bodies)
{
    const double whole = wb_bundle_model_tape_mass(bodies->model);
    const double lacking = 1.0 - bodies->ring.mass / whole;

    if (lacking <= max_missing_mass)
        return WB_OK;
    return reject_mesh(bodies, 1.05 * bodies->mesh->elements_along *
                                   pow(lacking / max_missing_mass, 1.0 / mass_order));
}

static enum wb_status make_ring(struct wb_bundle_bodies *bodies)
{
    const struct wb_bundle_tape *tape = &bodies->model->tape;
    const bool closed = tape->taping.kind == WB_TAPING_SLEEVE;
    const struct wb_swept_layout layout =
        wb_swept_layout(elements_of(bodies) + !closed, bodies->extent.n_stations);

    wb_bundle_bodies_create_fields(bodies, &bodies->ring, layout);
    wb_bundle_bodies_create_fields(bodies, &bodies->directors, layout);
    place_ring(bodies);
    const struct wb_swept_tape_model model = {
        .material = tape->material.material,
        .density = tape->material.density,
        .thickness = layer_thickness(&tape->taping),
        .layout = layout,
        .position = bodies->ring.position,
        .spacing = bodies->spacing,
        .counted = bodies->extent.own,
        .closed = closed,
        .double_precision = bodies->model->run.double_precision,
    };
    WB_TRY(wb_swept_tape_create(&bodies->tape, &model));
    bodies->tape_state = wb_swept_tape_state_create(bodies->tape);
    return WB_OK;
}

static enum wb_status make_steps(struct wb_bundle_bodies *bodies,
                                 const struct wb_bundle_bodies *whole)
{
    struct wb_bundle_body *ring = &bodies->ring, *directors = &bodies->directors;
    const size_t n = (size_t)ring->layout.n_nodes;
    double *const mass = wb_memory_take(&bodies->memory, n, sizeof *mass);
    double *const inertia = wb_memory_take(&bodies->memory, n, sizeof *inertia);

    wb_swept_tape_masses(whole ? whole->tape : bodies->tape, mass, inertia);
    ring->node_mass = mass;
    directors->node_mass = inertia;
    WB_TRY(wb_bundle_bodies_create_step(bodies, ring->layout, mass, bodies->gravity, &ring->step));
    return wb_bundle_bodies_create_step(bodies, directors->layout, inertia, 0.0, &directors->step);
}

enum wb_status wb_bundle_tape_create(struct wb_bundle_bodies *bodies,
                                     const struct wb_bundle_bodies *whole)
{
    struct wb_bundle_body *ring = &bodies->ring, *directors = &bodies->directors;
    const bool is_helix = bodies->model->tape.taping.kind == WB_TAPING_HELIX;

    if (is_helix)
        WB_TRY(check_twist(bodies));
    bodies->has_tape = true;
    WB_TRY(make_ring(bodies));
    memcpy(directors->position, wb_swept_tape_directors(bodies->tape),
           wb_swept_size(&directors->layout) * sizeof *directors->position);
    WB_TRY(make_steps(bodies, whole));
    for (int k = 0; k < ring->layout.n_nodes; k++) {
        const size_t tip = (size_t)(3 * k + 1) * (size_t)ring->layout.stride +
                           (size_t)bodies->extent.n_stations - 1;
        ring->mass += ring->node_mass[k];
        ring->start += ring->node_mass[k] * ring->position[tip];
    }
    ring->start /= ring->mass;
    return is_helix ? check_mass(bodies) : WB_OK;
}
