#include "analysis/dataset/simulated_bundle.h"

#include <math.h>
#include <stdio.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/dataset/simulated.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "fe/model/model_inputs.h"
#include "fe/section/section_run.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "dataset"

static const double poissons_ratio = 0.3; /* of the homogenised beam, as the paper has it */

/* --- rows --- */

static void add_rows(struct wb_dataset *dataset, const struct wb_bundle_result *result)
{
    const struct wb_simulated_shapes shapes = {result->n_shape, result->shape_s, result->shape};
    for (int i = 0; i < result->n_rows; i++) {
        const struct wb_bundle_row *const row = &result->rows[i];
        const struct wb_row out = {
            .cycle = row->cycle,
            .phase = row->phase,
            .deflection = row->deflection,
            .tension = row->tension,
            .force = row->force,
            .tip_angle = row->tip_angle,
        };
        wb_simulated_add_row(dataset, out, i > 0 ? result->rows[i - 1].tip : NULL, row->tip,
                             &shapes);
    }
}

static void set_info(struct wb_test_info *info, const struct wb_bundle_model *model)
{
    snprintf(info->wire, sizeof info->wire, "%s", model->name);
    info->length = model->length;
    info->outer_diameter =
        model->has_published ? model->published.outer_diameter : wb_bundle_model_diameter(model);
    info->mass_per_length = wb_bundle_model_wire_mass(model) + wb_bundle_model_tape_mass(model);
    info->poissons_ratio = poissons_ratio;
    info->strand_length = model->loads.strand_length;
    info->gravity = model->loads.weight ? WB_STANDARD_GRAVITY : 0.0;
    info->rest_level = (double)NAN;
    info->is_simulation = true;
}

/* --- dataset.json --- */

static void describe_interface(struct wb_json *simulation, const struct wb_bundle_model *model)
{
    const struct wb_bundle_interface *interface = &model->interface;

    wb_setting_set_json(wb_bundle_model_friction_setting, interface, simulation);
    if (!model->has_tape)
        return;
    struct wb_json *const cohesion = wb_json_set_object(simulation, "cohesion");
    wb_json_set_number(cohesion, "normal_stiffness_N_mm3",
                       interface->normal_stiffness / WB_N_PER_MM3);
    wb_json_set_number(cohesion, "shear_stiffness_N_mm3",
                       interface->shear_stiffness / WB_N_PER_MM3);
    if (!interface->has_damage)
        return;
    wb_json_set_number(cohesion, "strength_MPa", interface->damage.strength / WB_MPA);
    wb_json_set_number(cohesion, "shear_strength_MPa", interface->damage.shear_strength / WB_MPA);
    wb_json_set_number(cohesion, "fracture_energy_N_mm",
                       interface->damage.fracture_energy / WB_N_PER_MM);
}

static void describe_mesh(struct wb_json *object, const struct wb_simulated_bundle *bundle)
{
    const struct wb_bundle_mesh *mesh = bundle->mesh;
    struct wb_json *const out = wb_json_set_object(object, "mesh");
    const bool one_point = mesh->formulation == WB_BUNDLE_ONE_POINT;

    wb_json_set_text(out, "name", mesh->name);
    wb_json_set_integer(out, "section_quads", wb_bundle_model_section_quads(mesh));
    wb_json_set_integer(out, "elements_along", mesh->elements_along);
    wb_json_set_integer(out, "tape_quads", wb_bundle_model_tape_quads(bundle->model, mesh));
    wb_json_set_text(out, "formulation", one_point ? "one-point" : "2x2x1");
}

static void describe_energies(struct wb_json *object, const struct wb_bundle_energies *e)
{
    wb_json_set_number(object, "external_J", e->external);
    wb_json_set_number(object, "kinetic_J", e->kinetic);
    wb_json_set_number(object, "stored_J", e->stored);
    wb_json_set_number(object, "plastic_J", e->plastic);
    wb_json_set_number(object, "contact_J", e->contact);
    wb_json_set_number(object, "cohesive_J", e->cohesive);
    wb_json_set_number(object, "friction_J", e->friction);
    wb_json_set_number(object, "artificial_J", e->artificial);
    wb_json_set_number(object, "imbalance_J", wb_bundle_imbalance(e));
}

static void describe_largest(struct wb_json *object, const struct wb_simulated_bundle *bundle)
{
    const struct wb_bundle_result *h = bundle->result;
    struct wb_json *const largest = wb_json_set_object(object, "largest");

    wb_json_set_number(largest, "kinetic_over_internal", h->largest.kinetic);
    wb_json_set_number(largest, "artificial_over_internal", h->largest.artificial);
    wb_json_set_number(largest, "imbalance_over_external", h->largest.imbalance);
    wb_json_set_number(largest, "strain", h->largest.strain);
    wb_json_set_number(largest, "penetration_mm", h->largest.penetration / WB_MM);
    wb_json_set_boolean(largest, "beyond_strain_limit", h->largest.beyond);
}

/* A setting of the run, by its place in wb_bundle_model_run_settings. */
static void describe_setting(struct wb_json *object, const struct wb_bundle_model *model, int row)
{
    wb_setting_set_json(&wb_bundle_model_run_settings[row], &model->run, object);
}

void wb_simulated_bundle_describe(struct wb_json *object, const struct wb_simulated_bundle *bundle)
{
    const struct wb_bundle_result *h = bundle->result;
    const double element_steps = (double)h->all_steps * (double)h->hexahedra;

    describe_mesh(object, bundle);
    wb_json_set_integer(object, "elements", h->hexahedra);
    wb_json_set_integer(object, "shells", h->shells);
    wb_json_set_number(object, "time_step_s", h->time_step);
    wb_json_set_integer(object, "steps", h->steps);
    wb_json_set_integer(object, "steps_of_all_attempts", h->all_steps);
    wb_json_set_number(object, "duration_s", h->duration);
    wb_json_set_boolean(object, "duration_chosen", h->chosen);
    wb_json_set_integer(object, "attempts", h->attempts);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_KINETIC_LIMIT);
    wb_json_set_boolean(object, "limit_kept", !h->exceeded);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_MASS_SCALING);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_SELECTIVE);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_PRECISION);
    if (h->n_rows > 0)
        describe_energies(wb_json_set_object(object, "energy"), &h->rows[h->n_rows - 1].energies);
    describe_largest(object, bundle);
    wb_json_set_boolean(object, "converged", h->converged);
    wb_json_set_boolean(object, "stopped", h->stopped);
    if (!h->converged)
        wb_json_set_text(object, "problem", h->reason.text);
    wb_json_set_number(object, "zero_force_N", h->zero_force);
    wb_json_set_integer(object, "threads", h->parts > 0 ? h->parts / wb_team_ranks() : 1);
    wb_json_set_integer(object, "ranks", wb_team_ranks());
    wb_json_set_number(object, "wall_s", bundle->wall);
    wb_json_set_number(object, "cpu_s", bundle->cpu);
    if (element_steps > 0.0)
        wb_json_set_number(object, "ns_per_element_step", 1e9 * bundle->cpu / element_steps);
}

static void describe_override(struct wb_json *simulation, const struct wb_bundle_override *o)
{
    if (!o || wb_bundle_override_is_empty(o))
        return;
    struct wb_json *const out = wb_json_set_object(simulation, "overridden");

    for (int t = 0; t < WB_BUNDLE_OVERRIDE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[t];
        const char *const settings = (const char *)o + table->offset;
        for (size_t i = 0; i < table->n; i++) {
            if (wb_setting_is_given(&table->rows[i], settings))
                wb_setting_set_json(&table->rows[i], settings, out);
        }
    }
}

void wb_simulated_bundle_inputs(struct wb_json *object, const struct wb_bundle_model *model,
                                const struct wb_bundle_mesh *mesh)
{
    wb_json_set_text(object, "solver", mesh ? "bundle" : "section");
    wb_json_set_integer(object, "version", mesh ? WB_BUNDLE_RUN_VERSION : WB_SECTION_RUN_VERSION);
    wb_model_inputs_bundle(object, model, mesh);
}

void wb_simulated_bundle_sum(const struct wb_bundle_model *model, const struct wb_bundle_mesh *mesh,
                             char sha256[WB_SHA256_TEXT])
{
    struct wb_json *const inputs = wb_json_create();
    wb_simulated_bundle_inputs(inputs, model, mesh);
    wb_model_inputs_sum(inputs, sha256);
    wb_json_destroy(inputs);
}

struct wb_json *wb_simulated_bundle_begin(struct wb_dataset *dataset,
                                          const struct wb_simulated_bundle_head *head)
{
    const struct wb_bundle_model *const model = head->model;
    struct wb_json *const document = dataset->document;
    char name[128];

    set_info(&dataset->info, model);
    snprintf(name, sizeof name, "%s, %s", model->name, head->name);
    wb_json_set_text(document, "name", name);
    wb_json_set_boolean(document, "complete", head->is_complete);

    struct wb_json *const simulation = wb_json_set_object(document, "simulation");
    wb_json_set_text(simulation, "model", head->mesh ? "bundle" : "section");
    wb_json_set_text(simulation, "name", model->name);
    wb_json_set_text(simulation, "title", model->title);
    if (model->notes[0] != '\0')
        wb_json_set_text(simulation, "notes", model->notes);
    wb_json_set_text(simulation, "file", wb_file_name(model->path));
    wb_simulated_bundle_inputs(wb_json_set_object(simulation, "inputs"), model, head->mesh);
    wb_json_set_text(simulation, "law", "elastoplastic");
    wb_json_set_integer(simulation, "wires", model->packing.n);
    wb_json_set_boolean(simulation, "tape", model->has_tape);
    describe_interface(simulation, model);
    describe_override(simulation, head->override);
    return simulation;
}

void wb_simulated_bundle_fill(struct wb_dataset *dataset, const struct wb_simulated_bundle *bundle)
{
    const struct wb_simulated_bundle_head head = {
        .name = "simulated bundle",
        .model = bundle->model,
        .mesh = bundle->mesh,
        .override = bundle->override,
        .is_complete = bundle->result->converged && !bundle->result->stopped,
    };
    struct wb_json *const simulation = wb_simulated_bundle_begin(dataset, &head);

    if (bundle->surface_deflection > 0.0)
        wb_json_set_number(simulation, "surface_deflection_mm", bundle->surface_deflection / WB_MM);
    wb_simulated_bundle_describe(simulation, bundle);
    wb_simulated_describe_tool(dataset->document);
    add_rows(dataset, bundle->result);
}

/* --- energies.csv --- */

static const char header[] =
    "t_s,deflection_mm,model_time_s,external_J,kinetic_J,stored_J,plastic_J,contact_J,cohesive_J,"
    "friction_J,artificial_J,kinetic_over_internal,artificial_over_internal,imbalance_J\n";

static void append_row(struct wb_text *text, double t, const struct wb_bundle_row *row)
{
    const struct wb_bundle_energies *e = &row->energies;
    const double internal = wb_bundle_internal(e);
    const double columns[] = {t,
                              row->deflection,
                              row->time,
                              e->external,
                              e->kinetic,
                              e->stored,
                              e->plastic,
                              e->contact,
                              e->cohesive,
                              e->friction,
                              e->artificial,
                              internal > 0.0 ? e->kinetic / internal : (double)NAN,
                              internal > 0.0 ? e->artificial / internal : (double)NAN,
                              wb_bundle_imbalance(e)};

    wb_simulated_append_energies(text, columns, WB_COUNT(columns));
}

enum wb_status wb_simulated_bundle_write_energies(const struct wb_dataset *dataset,
                                                  const struct wb_simulated_bundle *bundle,
                                                  const char *folder)
{
    const struct wb_bundle_result *h = bundle->result;
    struct wb_text text = {0};

    if (dataset->n_rows != (size_t)h->n_rows)
        return wb_fail(WB_ERR_ARGUMENT, "%s: %d rows of energies for a dataset of %zu", folder,
                       h->n_rows, dataset->n_rows);
    wb_text_append(&text, "%s", header);
    for (int i = 0; i < h->n_rows; i++)
        append_row(&text, dataset->rows[i].t, &h->rows[i]);
    const enum wb_status status = wb_csv_table_write(folder, "energies.csv", &text);
    wb_text_release(&text);
    return status;
}
