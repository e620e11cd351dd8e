/* Datasets of wire models: wb_simulated_fill_wire() of analysis/simulated.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/dataset/simulated.h"
#include "base/file.h"
#include "base/units.h"
#include "fe/model/model_inputs.h"
#include "fe/trial/wire1d.h"

static const double megabyte = 1e6; /* bytes */

static const char *const kind_names[] = {
    [WB_WIRE_STEP_LOADS] = "loads",
    [WB_WIRE_STEP_DEFLECTION] = "deflection",
    [WB_WIRE_STEP_RELEASE] = "release",
};

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

static void describe_material(struct wb_json *object, const struct wb_material *material)
{
    wb_json_set_number(object, "youngs_modulus_MPa", material->youngs_modulus / WB_MPA);
    wb_json_set_number(object, "poissons_ratio", material->poissons_ratio);
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
        wb_json_set_text(object, "name", part->name);
        wb_json_set_number(object, "outer_diameter_mm", part->outer_diameter / WB_MM);
        wb_json_set_text(object, "material", part->material_name);
        wb_json_set_text(object, "source", part->source);
        wb_json_set_boolean(object, "substitute", part->is_substitute);
        describe_material(object, &part->material);
        wb_json_set_number(object, "density_g_cm3", part->density / WB_G_PER_CM3);
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
    wb_json_set_text(simulation, "name", model->name);
    wb_json_set_text(simulation, "title", model->title);
    if (model->notes[0] != '\0')
        wb_json_set_text(simulation, "notes", model->notes);
    wb_json_set_text(simulation, "file", wb_file_name(model->path));
    wb_simulated_wire_inputs(wb_json_set_object(simulation, "inputs"), model, is_solid);
    wb_json_set_text(simulation, "law", model->is_elastic ? "elastic" : "elastoplastic");
    describe_parts(simulation, model);
    wb_json_set_text(simulation, "clamp", model->clamp == WB_WIRE_CLAMP_FIXED ? "fixed" : "plane");
    struct wb_json *const gravity = wb_json_set_array(simulation, "gravity_m_s2");
    for (int i = 0; i < 3; i++)
        wb_json_append_number(gravity, model->gravity[i]);
}

/* Members that only the solid has. */
static void describe_solid(struct wb_json *simulation, const struct wb_wire_model *model,
                           const struct wb_wire3d_balance *balance)
{
    struct wb_json *const interface = wb_json_set_object(simulation, "interface");
    wb_json_set_text(interface, "kind", model->has_contact ? "contact" : "bonded");
    if (model->has_contact) {
        wb_json_set_number(interface, "friction", model->jacket_contact.friction);
        wb_json_set_number(interface, "normal_stiffness_N_mm3",
                           model->jacket_contact.normal_stiffness / WB_N_PER_MM3);
        wb_json_set_number(interface, "penetration_mm", balance->penetration / WB_MM);
        wb_json_set_number(interface, "opening_mm", balance->opening / WB_MM);
        wb_json_set_number(interface, "slip_mm", balance->slip / WB_MM);
        wb_json_set_number(interface, "sliding_mm", balance->sliding / WB_MM);
        wb_json_set_number(interface, "slip_limit_mm", balance->slip_limit / WB_MM);
    }
    struct wb_json *const mesh = wb_json_set_object(simulation, "mesh");
    wb_json_set_integer(mesh, "elements_along", model->elements_along);
    wb_json_set_integer(mesh, "section_density", model->section_density);
    wb_json_set_text(mesh, "integration",
                     model->integration == WB_INTEGRATION_REDUCED ? "reduced" : "selective");
    struct wb_json *const energy = wb_json_set_object(simulation, "energy");
    wb_json_set_number(energy, "work_J", balance->work);
    wb_json_set_number(energy, "elastic_J", balance->elastic);
    wb_json_set_number(energy, "dissipated_J", balance->dissipated);
    wb_json_set_number(energy, "friction_J", balance->friction);
}

/* The last row of each step that was begun. */
static void describe_steps(struct wb_json *simulation, const struct wb_dataset *dataset,
                           const struct wb_wire_model *model, const struct wb_wire_run *run)
{
    struct wb_json *const steps = wb_json_set_array(simulation, "steps");
    for (int i = 0; i < run->n_rows; i++) {
        const int step = run->rows[i].step;
        if (i + 1 < run->n_rows && run->rows[i + 1].step == step)
            continue;
        struct wb_json *const object = wb_json_append_object(steps);
        wb_json_set_text(object, "name", model->step[step].name);
        wb_json_set_text(object, "kind", kind_names[model->step[step].kind]);
        wb_json_set_integer(object, "last_row", i + 1);
        wb_json_set_number(object, "t_s", dataset->rows[i].t);
        wb_json_set_boolean(object, "complete", run->rows[i].fraction >= 1.0);
    }
}

static void describe_run(struct wb_json *simulation, const struct wb_simulated_wire *wire)
{
    const struct wb_wire_run *const run = wire->run;
    wb_json_set_integer(simulation, "elements", run->n_elements);
    wb_json_set_integer(simulation, "degrees_of_freedom", run->n_unknowns);
    wb_json_set_integer(simulation, "increments", run->increments);
    wb_json_set_integer(simulation, "iterations", run->iterations);
    wb_json_set_integer(simulation, "cutbacks", run->cutbacks);
    wb_json_set_boolean(simulation, "converged", run->converged);
    wb_json_set_boolean(simulation, "stopped", run->stopped);
    if (!run->converged)
        wb_json_set_text(simulation, "problem", run->problem);
    wb_json_set_number(simulation, "zero_force_N", run->zero_force);
    wb_json_set_number(simulation, "wall_s", wire->wall);
    wb_json_set_number(simulation, "cpu_s", wire->cpu);
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

    wb_simulated_describe_tool(document);
}

void wb_simulated_fill_wire(struct wb_dataset *dataset, const struct wb_simulated_wire *wire)
{
    set_info(&dataset->info, wire->model);
    add_rows(dataset, wire->run);
    describe(dataset, wire);
}
