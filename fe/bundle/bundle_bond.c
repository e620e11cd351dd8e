#include "fe/bundle/bundle_bond.h"

#include <math.h>
#include <stdlib.h>

#include "fe/bundle/bundle_private.h"
#include "fe/bundle/bundle_tape.h"
#include "fe/swept/swept_cohesion.h"
#include "fe/swept/swept_tape_contact.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    SAMPLES = 64,      /* of the outline, for each node of the ring */
    LOOK_INTERVAL = 20 /* steps between searches for contact, about those of a vibration of the tape
                          on its contact */
};

struct wb_bundle_bond {
    struct wb_bundle *bundle; /* borrowed: it owns this */
    struct wb_swept_cohesion *cohesion;
    struct wb_swept_cohesion *windings; /* of a helix, to each other; NULL of a sleeve */
    struct wb_swept_tape_contact *contact;
    double *ring_mass, *ring_inertia; /* (ring nodes) kg, kg m2: at an inner station, scaled */
};

/* What most of a ring node's part of the tape lies on, and how much of it: a wire, or the winding
 * below. Where the strip climbs on itself it lies on neither. */
static struct wb_swept_cohesion_bond find_partner(const struct wb_bundle *bundle, int node,
                                                  int station)
{
    const struct wb_swept_cohesion_bond nothing = {WB_SWEPT_COHESION_FREE, 0.0};
    const struct wb_bundle_tape_place here = wb_bundle_tape_place(bundle, node, station);
    const double element =
        fabs(wb_bundle_tape_place(bundle, node + 1.0, station).level - here.level);
    const struct wb_bundle_tape *tape = &bundle->model->tape;
    const double middle = tape->gap + 0.5 * wb_taping_thickness(&tape->taping);
    int count[WB_PACKING_MOST] = {0}, most = -1, n = 0;

    if (here.level >= 1.0 + 0.999 * element && element > 0.0)
        return (struct wb_swept_cohesion_bond){WB_SWEPT_COHESION_TAPE, 1.0};
    for (int i = 0; i < SAMPLES; i++) {
        const double at = node + (i + 0.5) / SAMPLES - 0.5;
        const struct wb_bundle_tape_place place = wb_bundle_tape_place(bundle, at, station);
        const int wire =
            wb_bundle_model_tape_wire(bundle->model, place.point.y, place.point.z, middle);
        n += place.is_tape;
        if (!place.is_tape || place.level >= 1.0 || wire < 0)
            continue;
        count[wire]++;
        if (most < 0 || count[wire] > count[most])
            most = wire;
    }
    if (most < 0)
        return nothing;
    return (struct wb_swept_cohesion_bond){most, (double)count[most] / n};
}

static void describe_wires(const struct wb_bundle *bundle,
                           struct wb_swept_cohesion_wire wires[WB_PACKING_MOST])
{
    for (int w = 0; w < bundle->n_wires; w++) {
        const int type = bundle->model->type_of[w];
        const struct wb_swept_section *section = &bundle->type[type].section;
        wires[w] = (struct wb_swept_cohesion_wire){
            .y = bundle->model->packing.wire[w].y,
            .z = bundle->model->packing.wire[w].z,
            .node = (const double(*)[2])section->node,
            .n_nodes = section->n_nodes,
            .n_surface = section->n_outline,
            .surface = section->outline,
            .radius = 0.5 * bundle->model->type[type].outer_diameter,
        };
    }
}

/* Bonds to wires, which may break, or those of windings to each other. */
static enum wb_status make_cohesion(const struct wb_bundle *bundle,
                                    const struct wb_swept_cohesion_wire *wires, bool windings,
                                    struct wb_swept_cohesion **out)
{
    const struct wb_bundle_interface *interface = &bundle->model->interface;
    const int n = bundle->ring.layout.n_nodes;
    struct wb_swept_cohesion_settings settings;
    struct wb_swept_cohesion_bond *bonds =
        calloc((size_t)n * (size_t)bundle->n_stations, sizeof *bonds);
    if (!bonds)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the tape's bonds");

    wb_swept_cohesion_default_settings(&settings);
    settings.normal_stiffness = interface->normal_stiffness;
    settings.shear_stiffness = interface->shear_stiffness;
    if (interface->has_damage && !windings) {
        settings.strength = interface->damage.strength;
        settings.shear_strength = interface->damage.shear_strength;
        settings.fracture_energy = interface->damage.fracture_energy;
    }
    for (int k = 0; k < n; k++) {
        for (int j = 0; j < bundle->n_stations; j++) {
            struct wb_swept_cohesion_bond *bond = &bonds[k * bundle->n_stations + j];
            *bond = find_partner(bundle, k, j);
            if ((bond->to == WB_SWEPT_COHESION_TAPE) != windings)
                *bond = (struct wb_swept_cohesion_bond){WB_SWEPT_COHESION_FREE, 0.0};
        }
    }
    const enum wb_status status =
        wb_swept_cohesion_create(out, bundle->tape, &settings, bundle->n_wires, wires, bonds);
    free(bonds);
    return status;
}

static enum wb_status make_contact(struct wb_bundle_bond *bond,
                                   const struct wb_swept_cohesion_wire *wires)
{
    const struct wb_bundle *bundle = bond->bundle;
    const struct wb_bundle_interface *interface = &bundle->model->interface;
    struct wb_swept_tape_contact_settings settings;

    wb_swept_tape_contact_default_settings(&settings);
    settings.normal_stiffness = interface->normal_stiffness;
    settings.shear_stiffness = interface->shear_stiffness;
    settings.friction_static = interface->friction_static;
    settings.friction_kinetic = interface->friction_kinetic;
    settings.friction_decay = interface->friction_decay;
    settings.refresh_interval = LOOK_INTERVAL;
    return wb_swept_tape_contact_create(&bond->contact, bundle->tape, bond->cohesion, &settings,
                                        bundle->n_wires, wires);
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

    struct wb_swept_cohesion_wire wires[WB_PACKING_MOST];
    describe_wires(bundle, wires);
    enum wb_status status = make_cohesion(bundle, wires, false, &bond->cohesion);
    if (status == WB_OK && bundle->model->tape.taping.kind == WB_TAPING_HELIX)
        status = make_cohesion(bundle, wires, true, &bond->windings);
    if (status == WB_OK)
        status = make_contact(bond, wires);
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
    wb_swept_tape_contact_destroy(bond->contact);
    wb_swept_cohesion_destroy(bond->cohesion);
    wb_swept_cohesion_destroy(bond->windings);
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
    struct wb_swept_tape_contact_sums touching = {0};

    wb_swept_cohesion_add_forces(bond->cohesion, &fields, 0, wb_swept_tape_blocks(bundle->tape),
                                 &sums);
    if (bond->windings)
        wb_swept_cohesion_add_forces(bond->windings, &fields, 0, wb_swept_tape_blocks(bundle->tape),
                                     &sums);
    WB_TRY(wb_swept_tape_contact_add_forces(bond->contact, &fields, bundle->time_step, &touching));
    *energies = (struct wb_bundle_bond_energies){
        .stored = sums.stored,
        .dissipated = sums.dissipated,
        .contact = touching.normal + touching.tangential,
        .friction = touching.friction,
        .deepest = touching.deepest,
    };
    return WB_OK;
}

void wb_bundle_bond_add_areas(const struct wb_bundle_bond *bond, double area[2])
{
    const struct wb_bundle *bundle = bond->bundle;

    for (int k = 0; k < bundle->ring.layout.n_nodes; k++)
        for (int j = bundle->own.first; j < bundle->own.end; j++) {
            if (wb_swept_cohesion_partner(bond->cohesion, k, j) == WB_SWEPT_COHESION_FREE)
                continue;
            const double of_node = wb_swept_tape_area(bundle->tape, k, j);
            area[0] += of_node;
            if (wb_swept_cohesion_damage(bond->cohesion, k, j) >= 1.0)
                area[1] += of_node;
        }
}

/* The bonds between windings do not break: they have no state. */
void wb_bundle_bond_visit(struct wb_bundle_bond *bond, struct wb_checkpoint *checkpoint)
{
    const size_t size = wb_swept_tape_contact_state_size(bond->contact);
    void *const state = malloc(size);
    size_t bytes;
    void *const damage = wb_swept_cohesion_data(bond->cohesion, &bytes);

    wb_checkpoint_visit(checkpoint, "damage", damage, bytes);
    if (!state) {
        checkpoint->status = wb_fail(WB_ERR_MEMORY, "out of memory for a checkpoint");
        return;
    }
    if (!checkpoint->restores)
        wb_swept_tape_contact_save(bond->contact, state);
    wb_checkpoint_visit(checkpoint, "tape contact", state, size);
    if (checkpoint->restores && checkpoint->status == WB_OK)
        wb_swept_tape_contact_restore(bond->contact, state);
    free(state);
}

double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass)
{
    return wb_swept_cohesion_wire_stiffness_per_mass(bond->cohesion, wire, mass) +
           wb_swept_tape_contact_wire_stiffness_per_mass(bond->contact, wire, mass);
}

double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond)
{
    const double *mass = bond->ring_mass, *inertia = bond->ring_inertia;
    const double windings =
        bond->windings ? wb_swept_cohesion_tape_stiffness_per_mass(bond->windings, mass, inertia)
                       : 0.0;

    return wb_swept_cohesion_tape_stiffness_per_mass(bond->cohesion, mass, inertia) + windings +
           wb_swept_tape_contact_stiffness_per_mass(bond->contact, mass, inertia);
}
