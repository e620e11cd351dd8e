#include "fe/bundle/bundle_bond.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fe/bundle/bundle_tape.h"
#include "fe/swept/swept_cohesion.h"
#include "fe/swept/swept_tape_contact.h"

enum {
    SAMPLES = 64,      /* points on the outline for each node of the ring */
    LOOK_INTERVAL = 20 /* steps between searches for contact; shorter than a vibration of the tape
                          on its contact */
};

struct wb_bundle_bond {
    struct wb_bundle_bodies *bodies; /* borrowed */
    struct wb_swept_cohesion *cohesion;
    struct wb_swept_cohesion *windings; /* between windings of a helix; NULL for a sleeve */
    struct wb_swept_tape_contact *contact;
};

/* The wire or lower winding that carries most of a ring node's tape, and the fraction it carries.
 * Where the strip climbs onto itself it has neither. */
static struct wb_swept_cohesion_bond find_partner(const struct wb_bundle_bodies *bodies, int node,
                                                  int station)
{
    const struct wb_swept_cohesion_bond nothing = {WB_SWEPT_COHESION_FREE, 0.0};
    const struct wb_bundle_tape_place here = wb_bundle_tape_place(bodies, node, station);
    const double element =
        fabs(wb_bundle_tape_place(bodies, node + 1.0, station).level - here.level);
    const struct wb_bundle_tape *tape = &bodies->model->tape;
    const double middle = tape->gap + 0.5 * wb_taping_thickness(&tape->taping);
    int count[WB_PACKING_MOST] = {0}, most = -1, n = 0;

    if (here.level >= 1.0 + 0.999 * element && element > 0.0)
        return (struct wb_swept_cohesion_bond){WB_SWEPT_COHESION_TAPE, 1.0};
    for (int i = 0; i < SAMPLES; i++) {
        const double at = node + (i + 0.5) / SAMPLES - 0.5;
        const struct wb_bundle_tape_place place = wb_bundle_tape_place(bodies, at, station);
        const int wire =
            wb_bundle_model_tape_wire(bodies->model, place.point.y, place.point.z, middle);
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

/* Creates bonds to wires, which may break, or bonds between windings. */
static enum wb_status make_cohesion(const struct wb_bundle_bodies *bodies,
                                    const struct wb_swept_wire *wires, bool windings,
                                    struct wb_swept_cohesion **out)
{
    const struct wb_bundle_interface *interface = &bodies->model->interface;
    const int n = bodies->ring.layout.n_nodes;
    struct wb_swept_cohesion_settings settings = {.normal_stiffness = interface->normal_stiffness,
                                                  .shear_stiffness = interface->shear_stiffness};
    struct wb_swept_cohesion_bond *const bonds =
        wb_memory_new((size_t)n * (size_t)bodies->extent.n_stations, sizeof *bonds);

    if (interface->has_damage && !windings) {
        settings.strength = interface->damage.strength;
        settings.shear_strength = interface->damage.shear_strength;
        settings.fracture_energy = interface->damage.fracture_energy;
    }
    for (int k = 0; k < n; k++) {
        for (int j = 0; j < bodies->extent.n_stations; j++) {
            struct wb_swept_cohesion_bond *bond = &bonds[k * bodies->extent.n_stations + j];
            *bond = find_partner(bodies, k, j);
            if ((bond->to == WB_SWEPT_COHESION_TAPE) != windings)
                *bond = (struct wb_swept_cohesion_bond){WB_SWEPT_COHESION_FREE, 0.0};
        }
    }
    const enum wb_status status =
        wb_swept_cohesion_create(out, bodies->tape, &settings, bodies->n_wires, wires, bonds);
    free(bonds);
    return status;
}

static enum wb_status make_contact(struct wb_bundle_bond *bond, const struct wb_swept_wire *wires,
                                   struct wb_reason *reason)
{
    const struct wb_bundle_bodies *bodies = bond->bodies;
    const struct wb_bundle_interface *interface = &bodies->model->interface;
    const struct wb_swept_tape_contact_settings settings = {
        .normal_stiffness = interface->normal_stiffness,
        .shear_stiffness = interface->shear_stiffness,
        .friction = interface->friction,
        .refresh_interval = LOOK_INTERVAL,
        .reason = reason,
    };
    return wb_swept_tape_contact_create(&bond->contact, bodies->tape, bond->cohesion, &settings,
                                        bodies->n_wires, wires);
}

enum wb_status wb_bundle_bond_create(struct wb_bundle_bond **out, struct wb_bundle_bodies *bodies,
                                     struct wb_reason *reason)
{
    *out = NULL;
    struct wb_bundle_bond *const bond = wb_memory_new(1, sizeof *bond);
    bond->bodies = bodies;

    struct wb_swept_wire wires[WB_PACKING_MOST];
    wb_bundle_bodies_describe(bodies, wires);
    enum wb_status status = make_cohesion(bodies, wires, false, &bond->cohesion);
    if (status == WB_OK && bodies->model->tape.taping.kind == WB_TAPING_HELIX)
        status = make_cohesion(bodies, wires, true, &bond->windings);
    if (status == WB_OK)
        status = make_contact(bond, wires, reason);
    if (status != WB_OK) {
        wb_bundle_bond_destroy(bond);
        return status;
    }
    *out = bond;
    return WB_OK;
}

void wb_bundle_bond_destroy(struct wb_bundle_bond *bond)
{
    if (!bond)
        return;
    wb_swept_tape_contact_destroy(bond->contact);
    wb_swept_cohesion_destroy(bond->cohesion);
    wb_swept_cohesion_destroy(bond->windings);
    free(bond);
}

enum wb_status wb_bundle_bond_add_forces(struct wb_bundle_bond *bond,
                                         struct wb_bundle_bond_energies *energies)
{
    struct wb_bundle_bodies *bodies = bond->bodies;
    const struct wb_swept_cohesion_fields fields = {
        .tape = {.position = bodies->ring.position,
                 .director = bodies->directors.position,
                 .force = bodies->ring.force,
                 .moment = bodies->directors.force},
        .position = bodies->positions,
        .force = bodies->forces,
    };
    struct wb_swept_cohesion_sums sums = {0};
    struct wb_swept_tape_contact_sums touching = {0};

    wb_swept_cohesion_add_forces(bond->cohesion, &fields, 0, wb_swept_tape_blocks(bodies->tape),
                                 &sums);
    if (bond->windings)
        wb_swept_cohesion_add_forces(bond->windings, &fields, 0, wb_swept_tape_blocks(bodies->tape),
                                     &sums);
    WB_TRY(wb_swept_tape_contact_add_forces(bond->contact, &fields, bodies->time_step, &touching));
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
    const struct wb_bundle_bodies *bodies = bond->bodies;

    for (int k = 0; k < bodies->ring.layout.n_nodes; k++)
        for (int j = bodies->extent.own.first; j < bodies->extent.own.end; j++) {
            if (wb_swept_cohesion_partner(bond->cohesion, k, j) == WB_SWEPT_COHESION_FREE)
                continue;
            const double of_node = wb_swept_tape_area(bodies->tape, k, j);
            area[0] += of_node;
            if (wb_swept_cohesion_damage(bond->cohesion, k, j) >= 1.0)
                area[1] += of_node;
        }
}

/* Bonds between windings do not break: they have no state. */
void wb_bundle_bond_visit(struct wb_bundle_bond *bond, struct wb_checkpoint *checkpoint)
{
    size_t bytes;
    void *const damage = wb_swept_cohesion_data(bond->cohesion, &bytes);

    wb_checkpoint_visit(checkpoint, "damage", damage, bytes);
    wb_swept_tape_contact_visit(bond->contact, checkpoint);
}

double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass)
{
    return wb_swept_cohesion_wire_stiffness_per_mass(bond->cohesion, wire, mass) +
           wb_swept_tape_contact_wire_stiffness_per_mass(bond->contact, wire, mass);
}

double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond)
{
    const struct wb_bundle_bodies *bodies = bond->bodies;
    const int n = bodies->ring.layout.n_nodes;
    const double scale = bodies->spacing * bodies->model->run.mass_scaling;
    double *const mass = wb_memory_new(2 * (size_t)n, sizeof *mass), *const inertia = mass + n;

    for (int k = 0; k < n; k++) {
        mass[k] = bodies->ring.node_mass[k] * scale;
        inertia[k] = bodies->directors.node_mass[k] * scale;
    }
    double sum = wb_swept_cohesion_tape_stiffness_per_mass(bond->cohesion, mass, inertia);
    if (bond->windings)
        sum += wb_swept_cohesion_tape_stiffness_per_mass(bond->windings, mass, inertia);
    sum += wb_swept_tape_contact_stiffness_per_mass(bond->contact, mass, inertia);
    free(mass);
    return sum;
}
