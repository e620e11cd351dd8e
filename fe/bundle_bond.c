#include "fe/bundle_bond.h"

#include <stdlib.h>

#include "fe/bundle_private.h"
#include "fe/swept_cohesion.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    SAMPLES = 64 /* of the outline, for each node of the ring */
};

struct wb_bundle_bond {
    struct wb_bundle *bundle; /* borrowed: it owns this */
    struct wb_swept_cohesion *cohesion;
    double *ring_mass, *ring_inertia; /* (ring nodes) kg, kg m2: at an inner station, scaled */
};

/* The wire that most of a ring node's part of the outline lies on, and how much of it. */
static struct wb_swept_cohesion_bond find_partner(const struct wb_bundle *bundle, double offset,
                                                  int node)
{
    const struct wb_hull *hull = &bundle->model->tape.hull;
    const int n = bundle->ring.layout.n_nodes;
    const double around = wb_hull_length(hull, offset);
    int count[WB_PACKING_MOST] = {0}, most = -1;

    for (int i = 0; i < SAMPLES; i++) {
        const double at = node + (i + 0.5) / SAMPLES - 0.5;
        const int wire = wb_hull_at(hull, offset, -around * at / n).wire;
        if (wire < 0)
            continue;
        count[wire]++;
        if (most < 0 || count[wire] > count[most])
            most = wire;
    }
    /* A node over a gap that only borders on a wire faces nothing. */
    if (most < 0 || wb_hull_at(hull, offset, -around * node / n).wire != most)
        return (struct wb_swept_cohesion_bond){WB_SWEPT_COHESION_FREE, 0.0};
    return (struct wb_swept_cohesion_bond){most, (double)count[most] / SAMPLES};
}

static enum wb_status make_cohesion(struct wb_bundle_bond *bond)
{
    const struct wb_bundle *bundle = bond->bundle;
    const struct wb_bundle_interface *interface = &bundle->model->interface;
    const struct wb_bundle_tape *tape = &bundle->model->tape;
    const double offset = tape->gap + 0.5 * wb_taping_thickness(&tape->taping);
    const int n = bundle->ring.layout.n_nodes;
    struct wb_swept_cohesion_wire wires[WB_PACKING_MOST];
    struct wb_swept_cohesion_settings settings;
    struct wb_swept_cohesion_bond *bonds =
        calloc((size_t)n * (size_t)bundle->n_stations, sizeof *bonds);
    if (!bonds)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the tape's bonds");

    wb_swept_cohesion_default_settings(&settings);
    settings.normal_stiffness = interface->normal_stiffness;
    settings.shear_stiffness = interface->shear_stiffness;
    if (interface->has_damage) {
        settings.strength = interface->damage.strength;
        settings.shear_strength = interface->damage.shear_strength;
        settings.fracture_energy = interface->damage.fracture_energy;
    }
    for (int w = 0; w < bundle->n_wires; w++) {
        const struct wb_swept_section *section = &bundle->type[bundle->model->type_of[w]].section;
        wires[w] = (struct wb_swept_cohesion_wire){
            .y = bundle->model->packing.wire[w].y,
            .z = bundle->model->packing.wire[w].z,
            .node = (const double(*)[2])section->node,
            .n_nodes = section->n_nodes,
            .n_surface = section->n_outline,
            .surface = section->outline,
        };
    }
    for (int k = 0; k < n; k++) {
        const struct wb_swept_cohesion_bond partner = find_partner(bundle, offset, k);
        for (int j = 0; j < bundle->n_stations; j++)
            bonds[k * bundle->n_stations + j] = partner;
    }
    const enum wb_status status = wb_swept_cohesion_create(&bond->cohesion, bundle->tape, &settings,
                                                           bundle->n_wires, wires, bonds);
    free(bonds);
    return status;
}

static enum wb_status scale_masses(struct wb_bundle_bond *bond)
{
    const struct wb_bundle *bundle = bond->bundle;
    const size_t n = (size_t)bundle->ring.layout.n_nodes;
    const double scale = bundle->spacing * bundle->model->run.mass_scaling;

    bond->ring_mass = calloc(n, sizeof *bond->ring_mass);
    bond->ring_inertia = calloc(n, sizeof *bond->ring_inertia);
    if (!bond->ring_mass || !bond->ring_inertia)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the tape's bonds");
    for (size_t k = 0; k < n; k++) {
        bond->ring_mass[k] = bundle->tape_mass[k] * scale;
        bond->ring_inertia[k] = bundle->tape_inertia[k] * scale;
    }
    return WB_OK;
}

enum wb_status wb_bundle_bond_create(struct wb_bundle_bond **out, struct wb_bundle *bundle)
{
    *out = NULL;
    struct wb_bundle_bond *bond = calloc(1, sizeof *bond);
    if (!bond)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the tape's bonds");
    bond->bundle = bundle;

    enum wb_status status = make_cohesion(bond);
    if (status == WB_OK)
        status = scale_masses(bond);
    if (status != WB_OK)
        wb_bundle_bond_destroy(bond);
    else
        *out = bond;
    return status;
}

void wb_bundle_bond_destroy(struct wb_bundle_bond *bond)
{
    if (!bond)
        return;
    wb_swept_cohesion_destroy(bond->cohesion);
    free(bond->ring_mass);
    free(bond->ring_inertia);
    free(bond);
}

enum wb_status wb_bundle_bond_add_forces(struct wb_bundle_bond *bond,
                                         struct wb_bundle_bond_energies *energies)
{
    struct wb_bundle *bundle = bond->bundle;
    const struct wb_swept_cohesion_fields fields = {
        .tape = {.position = bundle->ring.position,
                 .director = bundle->directors.position,
                 .force = bundle->ring.force,
                 .moment = bundle->directors.force},
        .position = bundle->positions,
        .force = bundle->forces,
    };
    struct wb_swept_cohesion_sums sums = {0};

    wb_swept_cohesion_add_forces(bond->cohesion, &fields, 0, wb_swept_tape_blocks(bundle->tape),
                                 &sums);
    energies->stored = sums.stored;
    energies->dissipated = sums.dissipated;
    return WB_OK;
}

double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass)
{
    return wb_swept_cohesion_wire_stiffness_per_mass(bond->cohesion, wire, mass);
}

double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond)
{
    return wb_swept_cohesion_tape_stiffness_per_mass(bond->cohesion, bond->ring_mass,
                                                     bond->ring_inertia);
}
