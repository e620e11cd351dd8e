/* Datasets of wire models: wb_simulated_fill_wire() of analysis/simulated.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/dataset/simulated.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "base/file.h"
#include "base/units.h"
#include "fe/model/model_inputs.h"
#include "fe/trial/wire1d.h"

static const double megabyte = 1e6; /* bytes */

static void add_rows(struct wb_dataset *dataset, const struct wb_wire_run *run)
{
    const struct wb_simulated_shapes shapes = {run->n_shape, run->shape_s, run->shape};
    for (int i = 0; i < run->n_rows; i++) {
        const struct wb_wire_row *const row = &run->rows[i];
        const struct wb_row out = {
            .cycle = row->cycle,
            .phase = row->phase,
            .deflection = row->tip[1],
            .tension = row->tension,
            .force = row->force,
            .tip_angle = row->tip_angle,
        };
        wb_simulated_add_row(dataset, out, i > 0 ? run->rows[i - 1].tip : NULL, row->tip, &shapes);
    }
}

static void set_info(struct wb_test_info *info, const struct wb_wire_model *model)
{
    snprintf(info->wire, sizeof info->wire, "%s", model->wire.name);
    info->length = model->length;
    info->outer_diameter = model->part[model->n_parts - 1].outer_diameter;
    info->mass_per_length = wb_wire_model_mass_per_length(model);
    info->poissons_ratio = wb_wire_model_poissons_ratio(model);
    info->strand_length = model->strand_length;
    info->is_general = !wb_wire_model_is_bending_test(model);
    info->is_follower = !info->is_general && wb_wire_model_is_follower(model);
    info->gravity = 0.0 - model->gravity[1]; /* no -0 */
    info->rest_level = (double)NAN;
    info->is_simulation = true;
}

/* --- dataset.json --- */

#define MODEL(member) WB_AT(struct wb_wire_model, member)
#define PART(member) WB_AT(struct wb_wire_model_part, member)
#define BALANCE(member) WB_AT(struct wb_wire3d_balance, member)
#define RUN(member) WB_AT(struct wb_wire_run, member)

static const struct wb_key wire_part_rows[] = {
    {"name", PART(name), "name of the part"},
    {"outer_diameter_mm", PART(outer_diameter), "outer diameter"},
    {"material", PART(material_name), "name of the material"},
    {"source", PART(source), "source of the values"},
    {"substitute", PART(is_substitute), "the values replace lost ones"},
    {"youngs_modulus_MPa", PART(material.youngs_modulus), "Young's modulus"},
    {"poissons_ratio", PART(material.poissons_ratio), "Poisson's ratio"},
    {"hardening", TEXT | OPTIONAL, "hardening; absent: elastic", .choices = "isotropic|kinematic"},
    {"yield_stress_MPa", NUMBER | OPTIONAL, "yield stress"},
    {"strength_coefficient_MPa", NUMBER | OPTIONAL, "strength coefficient"},
    {"hardening_exponent", NUMBER | OPTIONAL, "hardening exponent, of isotropic hardening"},
    {"density_g_cm3", PART(density), "density"},
};
static WB_KEYS(wire_part, "wire_part", "A part of a wire model.");

static const struct wb_key homogenised_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "Young's modulus by the flexural rule of mixtures"},
    {"poissons_ratio", NUMBER, "Poisson's ratio by areas"},
};
static WB_KEYS(homogenised, "homogenised", "The homogenised section.");

static const struct wb_key interface_rows[] = {
    {"kind", WB_CHOICE(struct wb_wire_model, has_contact), "interface between core and jacket",
     .choices = "bonded|contact"},
    {"friction", MODEL(jacket_contact.friction) | OPTIONAL, "friction coefficient"},
    {"normal_stiffness_N_mm3", MODEL(jacket_contact.normal_stiffness) | OPTIONAL,
     "normal stiffness of the contact"},
    {"penetration_mm", BALANCE(penetration) | OPTIONAL, "largest penetration at the end"},
    {"opening_mm", BALANCE(opening) | OPTIONAL, "largest opening at the end"},
    {"slip_mm", BALANCE(slip) | OPTIONAL, "largest accumulated slip at the end"},
    {"sliding_mm", BALANCE(sliding) | OPTIONAL,
     "largest sliding of points that lay on each other, in the whole computation"},
    {"slip_limit_mm", BALANCE(slip_limit) | OPTIONAL,
     "sliding beyond which the assumption of small sliding does not hold"},
};
static WB_KEYS(interface, "interface",
               "The interface of core and jacket; numbers of contact only.");

static const struct wb_key wb_simulated_wire_mesh_rows[] = {
    {"elements_along", MODEL(elements_along), "elements along the wire"},
    {"section_density", MODEL(section_density), "refinement of the section"},
    {"integration", WB_CHOICE(struct wb_wire_model, integration), "integration of the elements",
     .choices = "selective|reduced"},
};
WB_KEYS(wb_simulated_wire_mesh, "mesh_of_solid", "The mesh of a solid wire.");

static const struct wb_key solid_energy_rows[] = {
    {"work_J", BALANCE(work), "work of the loads"},
    {"elastic_J", BALANCE(elastic), "stored elastic energy"},
    {"dissipated_J", BALANCE(dissipated), "energy dissipated by plasticity"},
    {"friction_J", BALANCE(friction), "energy dissipated by friction"},
};
static WB_KEYS(solid_energy, "energy_of_solid", "Energies at the end of the computation.");

static const struct wb_key step_rows[] = {
    {"name", WB_AT(struct wb_wire_step, name), "name of the step"},
    {"kind", WB_CHOICE(struct wb_wire_step, kind), "what the step applies",
     .choices = "loads|deflection|release"},
    {"last_row", INTEGER, "last row of the step, from 1"},
    {"t_s", NUMBER, "time of that row"},
    {"complete", FLAG, "the step was computed to its end"},
};
static WB_KEYS(step, "step", "A step of the model that was begun.");

static const struct wb_key wb_simulated_wire_rows[] = {
    {"name", MODEL(name), "name of the model"},
    {"title", MODEL(title), "title of the model"},
    {"notes", MODEL(notes) | IF_KNOWN, "notes of the model"},
    {"file", TEXT, "file of the model"},
    {"sha256", TEXT | OPTIONAL, "of older datasets: SHA-256 of the model's files"},
    {"law", TEXT, "whether the wire may yield", .choices = "elastic|elastoplastic"},
    {"parts", OBJECT | LIST, "parts of the wire, from the inside out", &wire_part_keys},
    {"substitutes", FLAG, "values of a part replace lost ones"},
    {"homogenised", OBJECT, "homogenised section", &homogenised_keys},
    {"clamp", WB_CHOICE(struct wb_wire_model, clamp), "boundary condition at the clamp",
     .choices = "plane|fixed"},
    {"gravity_m_s2", WB_FULL(struct wb_wire_model, gravity), "gravity: x, y, z"},
    {"interface", OBJECT | OPTIONAL, "of wire3d: interface of core and jacket", &interface_keys},
    {"mesh", WB_HERE(struct wb_wire_model) | OPTIONAL, "of wire3d: mesh",
     &wb_simulated_wire_mesh_keys},
    {"energy", WB_HERE(struct wb_wire3d_balance) | OPTIONAL, "of wire3d: energies at the end",
     &solid_energy_keys},
    {"elements", RUN(n_elements), "number of elements"},
    {"degrees_of_freedom", RUN(n_unknowns), "number of unknowns"},
    {"increments", RUN(increments), "increments of the loading"},
    {"iterations", RUN(iterations), "iterations of the equilibrium"},
    {"cutbacks", RUN(cutbacks), "increments that were repeated with a smaller step"},
    {"converged", RUN(converged), "the whole loading was computed"},
    {"stopped", RUN(stopped), "stopped by Ctrl-C"},
    {"problem", TEXT | OPTIONAL, "where and why the computation did not converge"},
    {"zero_force_N", RUN(zero_force) | UNKNOWN, "vertical force that `force_N` is counted from"},
    {"wall_s", WB_AT(struct wb_simulated_wire, wall), "time of the computation"},
    {"cpu_s", WB_AT(struct wb_simulated_wire, cpu), "CPU time of the computation"},
    {"peak_memory_MB", NUMBER | OPTIONAL, "largest memory of the process"},
    {"steps", OBJECT | LIST, "steps of the model that were begun", &step_keys},
};
WB_KEYS(wb_simulated_wire, "wire_keys", "");

static void describe_yield(struct wb_json *object, const struct wb_material *material)
{
    if (material->hardening == WB_HARDENING_NONE_ELASTIC)
        return;
    const bool kinematic = material->hardening == WB_HARDENING_KINEMATIC_LINEAR;
    wb_json_set_text(object, "hardening", kinematic ? "kinematic" : "isotropic");
    wb_json_set_number(object, "yield_stress_MPa", material->yield_stress / WB_MPA);
    wb_json_set_number(object, "strength_coefficient_MPa", material->strength_coefficient / WB_MPA);
    if (!kinematic)
        wb_json_set_number(object, "hardening_exponent", material->hardening_exponent);
}

static void describe_parts(struct wb_json *simulation, const struct wb_wire_model *model)
{
    struct wb_json *const parts = wb_json_set_array(simulation, "parts");
    bool substitutes = false;
    for (int i = 0; i < model->n_parts; i++) {
        const struct wb_wire_model_part *const part = &model->part[i];
        struct wb_json *const object = wb_json_append_object(parts);
        WB_PUT(object, &wire_part_keys, struct wb_wire_model_part, part);
        describe_yield(object, &part->material);
        WB_PUT(object, &wire_part_keys, struct wb_wire_model_part, part);
        substitutes = substitutes || part->is_substitute;
    }
    wb_json_set_boolean(simulation, "substitutes", substitutes);

    struct wb_json *const whole = wb_json_set_object(simulation, "homogenised");
    wb_json_set_number(whole, "youngs_modulus_MPa", wb_wire_model_youngs_modulus(model) / WB_MPA);
    wb_json_set_number(whole, "poissons_ratio", wb_wire_model_poissons_ratio(model));
}

void wb_simulated_wire_inputs(struct wb_json *object, const struct wb_wire_model *model,
                              bool is_solid)
{
    wb_json_set_text(object, "solver", is_solid ? "wire3d" : "wire1d");
    wb_json_set_integer(object, "version", is_solid ? WB_WIRE3D_VERSION : WB_WIRE1D_VERSION);
    wb_model_inputs_wire(object, model, is_solid);
}

static void describe_model(struct wb_json *simulation, const struct wb_wire_model *model,
                           bool is_solid)
{
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_wire_model, model);
    wb_json_set_text(simulation, "file", wb_file_name(model->path));
    wb_simulated_wire_inputs(wb_json_set_object(simulation, "inputs"), model, is_solid);
    wb_json_set_text(simulation, "law", model->is_elastic ? "elastic" : "elastoplastic");
    describe_parts(simulation, model);
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_wire_model, model);
}

/* Members that only the solid has. */
static void describe_solid(struct wb_json *simulation, const struct wb_wire_model *model,
                           const struct wb_wire3d_balance *balance)
{
    struct wb_json *const object = wb_json_set_object(simulation, "interface");
    if (model->has_contact) {
        WB_PUT(object, &interface_keys, struct wb_wire_model, model);
        WB_PUT(object, &interface_keys, struct wb_wire3d_balance, balance);
    } else {
        wb_json_set_text(object, "kind", "bonded");
    }
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_wire_model, model);
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_wire3d_balance, balance);
}

/* The last row of each step that was begun. */
static void describe_steps(struct wb_json *simulation, const struct wb_dataset *dataset,
                           const struct wb_wire_model *model, const struct wb_wire_run *run)
{
    struct wb_json *const steps = wb_json_set_array(simulation, "steps");
    for (int i = 0; i < run->n_rows; i++) {
        const int index = run->rows[i].step;
        if (i + 1 < run->n_rows && run->rows[i + 1].step == index)
            continue;
        struct wb_json *const object = wb_json_append_object(steps);
        WB_PUT(object, &step_keys, struct wb_wire_step, &model->step[index]);
        wb_json_set_integer(object, "last_row", i + 1);
        wb_json_set_number(object, "t_s", dataset->rows[i].t);
        wb_json_set_boolean(object, "complete", run->rows[i].fraction >= 1.0);
    }
}

static void describe_run(struct wb_json *simulation, const struct wb_simulated_wire *wire)
{
    const struct wb_wire_run *const run = wire->run;
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_wire_run, run);
    if (!run->converged)
        wb_json_set_text(simulation, "problem", run->problem);
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_wire_run, run);
    WB_PUT(simulation, &wb_simulated_wire_keys, struct wb_simulated_wire, wire);
    if (wire->peak_memory > 0.0)
        wb_json_set_number(simulation, "peak_memory_MB", wire->peak_memory / megabyte);
}

static void describe(struct wb_dataset *dataset, const struct wb_simulated_wire *wire)
{
    struct wb_json *const document = dataset->document;
    char name[128];
    snprintf(name, sizeof name, "%s, simulated %s", wire->model->name, wire->solver);
    wb_json_set_text(document, "name", name);
    wb_json_set_boolean(document, "complete", wire->run->converged && !wire->run->stopped);

    struct wb_json *const simulation = wb_json_set_object(document, "simulation");
    wb_json_set_text(simulation, "model", wire->solver);
    describe_model(simulation, wire->model, strcmp(wire->solver, "wire3d") == 0);
    if (wire->balance)
        describe_solid(simulation, wire->model, wire->balance);
    describe_run(simulation, wire);
    describe_steps(simulation, dataset, wire->model, wire->run);

    wb_keys_put_tool(document, "wirebench");
}

void wb_simulated_fill_wire(struct wb_dataset *dataset, const struct wb_simulated_wire *wire)
{
    set_info(&dataset->info, wire->model);
    add_rows(dataset, wire->run);
    describe(dataset, wire);
}
