#include "analysis/dataset/simulated_bundle.h"

#include <math.h>
#include <stdio.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/dataset/simulated.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
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

#define MODEL(member) WB_AT(struct wb_bundle_model, member)
#define INTERFACE(member) WB_AT(struct wb_bundle_interface, member)
#define DAMAGE(member) WB_AT(struct wb_bundle_damage, member)
#define MESH(member) WB_AT(struct wb_bundle_mesh, member)
#define RESULT(member) WB_AT(struct wb_bundle_result, member)
#define ENERGY(member) WB_AT(struct wb_bundle_energies, member)
#define LARGEST(member) WB_AT(struct wb_bundle_extremes, member)

static const struct wb_key cohesion_rows[] = {
    {"normal_stiffness_N_mm3", INTERFACE(normal_stiffness), "normal stiffness"},
    {"shear_stiffness_N_mm3", INTERFACE(shear_stiffness), "shear stiffness"},
    {"strength_MPa", DAMAGE(strength) | OPTIONAL, "strength; absent: the bond does not fail"},
    {"shear_strength_MPa", DAMAGE(shear_strength) | OPTIONAL, "shear strength"},
    {"fracture_energy_N_mm", DAMAGE(fracture_energy) | OPTIONAL, "fracture energy"},
};
static WB_KEYS(cohesion, "cohesion", "The bond between tape and wires.");

static const struct wb_setting_table friction_setting = {wb_bundle_model_friction_setting, 1};

static const struct wb_key override_rows[] = {
#define OVERRIDES(of)                                                                              \
    {                                                                                              \
        .type = OPTIONAL, .settings = &wb_bundle_override_tables[WB_BUNDLE_OVERRIDE_##of]          \
    }
    OVERRIDES(MESH), OVERRIDES(PIECE),    OVERRIDES(TEST),     OVERRIDES(LOADS),
    OVERRIDES(RUN),  OVERRIDES(FRICTION), OVERRIDES(COHESION),
#undef OVERRIDES
};
static WB_KEYS(override, "overridden",
               "The settings of the bundle's file that options of the command replaced.");

static const struct wb_key wb_simulated_bundle_head_rows[] = {
    {"name", MODEL(name), "name of the model"},
    {"title", MODEL(title), "title of the model"},
    {"notes", MODEL(notes) | IF_KNOWN, "notes of the model"},
    {"file", TEXT, "file of the model"},
    {"law", TEXT, "whether wires may yield", .choices = "elastoplastic"},
    {"wires", MODEL(packing.n), "number of wires"},
    {"tape", MODEL(has_tape), "there is a tape"},
    {.settings = &friction_setting, MODEL(interface)},
    {"cohesion", OBJECT | OPTIONAL, "bond between tape and wires", &cohesion_keys},
    {"overridden", OBJECT | OPTIONAL, "settings that options replaced", &override_keys},
};
WB_KEYS(wb_simulated_bundle_head, "bundle_keys", "");

static const struct wb_key bundle_mesh_rows[] = {
    {"name", MESH(name), "name of the mesh"},
    {"section_quads", INTEGER, "quadrilaterals of a wire's section"},
    {"elements_along", MESH(elements_along), "elements along the bundle"},
    {"tape_quads", INTEGER, "quadrilaterals round the tape"},
    {"formulation", WB_CHOICE(struct wb_bundle_mesh, formulation), "integration of the hexahedra",
     .choices = "2x2x1|one-point"},
};
static WB_KEYS(bundle_mesh, "mesh_of_bundle", "The mesh of a bundle.");

static const struct wb_key bundle_energy_rows[] = {
    {"external_J", ENERGY(external),
     "work of the tip's force and of the weight, less the kinetic energy removed when the strand "
     "became slack"},
    {"kinetic_J", ENERGY(kinetic), "kinetic energy of the scaled masses"},
    {"stored_J", ENERGY(stored), "elastic energy of wires and tape"},
    {"plastic_J", ENERGY(plastic), "energy dissipated by plasticity of wires and tape"},
    {"contact_J", ENERGY(contact), "energy stored in contact between wires, and of tape and wires"},
    {"cohesive_J", ENERGY(cohesive),
     "energy stored in the tape's bond and dissipated by its damage"},
    {"friction_J", ENERGY(friction), "energy dissipated by friction"},
    {"artificial_J", ENERGY(artificial), "energy of the hourglass stiffness"},
    {"imbalance_J", NUMBER, "external work less all other energies"},
};
static WB_KEYS(bundle_energy, "energy_of_bundle", "Energies at the last row.");

static const struct wb_key bundle_largest_rows[] = {
    {"kinetic_over_internal", LARGEST(kinetic) | UNKNOWN,
     "kinetic over internal energy, from 2 mm of deflection on (or half the deflection)"},
    {"artificial_over_internal", LARGEST(artificial) | UNKNOWN, "artificial over internal energy"},
    {"imbalance_over_external", LARGEST(imbalance) | UNKNOWN,
     "imbalance over the largest external work so far"},
    {"strain", LARGEST(strain), "logarithmic strain"},
    {"penetration_mm", LARGEST(penetration), "penetration of wires"},
    {"beyond_strain_limit", LARGEST(beyond),
     "a strain exceeds 5 % in wires or 10 % in the tape, beyond which the elements' logarithmic "
     "strain is not accurate"},
};
static WB_KEYS(bundle_largest, "largest_of_bundle", "Largest values of the run.");

static const struct wb_key wb_simulated_bundle_rows[] = {
    {"mesh", OBJECT, "mesh", &bundle_mesh_keys},
    {"elements", RESULT(hexahedra), "number of hexahedra"},
    {"shells", RESULT(shells), "number of shells"},
    {"time_step_s", RESULT(time_step) | UNKNOWN, "time step"},
    {"steps", RESULT(steps), "time steps of the last attempt"},
    {"steps_of_all_attempts", RESULT(all_steps), "time steps of all attempts"},
    {"duration_s", RESULT(duration), "duration of a loading in the model's time"},
    {"duration_chosen", RESULT(chosen),
     "the duration was chosen from the limit of the kinetic energy"},
    {"attempts", RESULT(attempts), "attempts that the choice took"},
    {"kinetic_energy_limit", NUMBER, "limit of kinetic over internal energy"},
    {"limit_kept", FLAG, "the last attempt kept that limit"},
    {"mass_scaling", NUMBER, "mass scaling f_m of eq. 29"},
    {"selective_mass_scaling", NUMBER, "selective mass scaling beta; 1: none"},
    {"precision", TEXT | OPTIONAL,
     "precision of forces and of stored states of the material; absent: single",
     .choices = "single|double"},
    {"energy", OBJECT | OPTIONAL, "energies at the last row", &bundle_energy_keys},
    {"largest", RESULT(largest), "largest values of the run", &bundle_largest_keys},
    {"converged", RESULT(converged), "the whole loading was computed"},
    {"stopped", RESULT(stopped), "stopped by Ctrl-C"},
    {"problem", TEXT | OPTIONAL, "where and why the computation failed"},
    {"zero_force_N", RESULT(zero_force) | UNKNOWN, "vertical force that `force_N` is counted from"},
    {"threads", INTEGER, "threads of a process"},
    {"ranks", INTEGER, "processes of MPI"},
    {"wall_s", WB_AT(struct wb_simulated_bundle, wall), "time of the computation"},
    {"cpu_s", WB_AT(struct wb_simulated_bundle, cpu), "CPU time of the computation"},
    {"ns_per_element_step", NUMBER | OPTIONAL, "CPU time over hexahedra and steps", .unit = "ns"},
};
WB_KEYS(wb_simulated_bundle, "explicit_keys", "");

static void describe_cohesion(struct wb_json *simulation,
                              const struct wb_bundle_interface *interface)
{
    struct wb_json *const object = wb_json_set_object(simulation, "cohesion");
    WB_PUT(object, &cohesion_keys, struct wb_bundle_interface, interface);
    if (interface->has_damage)
        WB_PUT(object, &cohesion_keys, struct wb_bundle_damage, &interface->damage);
}

static void describe_mesh(struct wb_json *object, const struct wb_simulated_bundle *bundle)
{
    const struct wb_bundle_mesh *mesh = bundle->mesh;
    struct wb_json *const out = wb_json_set_object(object, "mesh");

    WB_PUT(out, &bundle_mesh_keys, struct wb_bundle_mesh, mesh);
    wb_json_set_integer(out, "section_quads", wb_bundle_model_section_quads(mesh));
    WB_PUT(out, &bundle_mesh_keys, struct wb_bundle_mesh, mesh);
    wb_json_set_integer(out, "tape_quads", wb_bundle_model_tape_quads(bundle->model, mesh));
    WB_PUT(out, &bundle_mesh_keys, struct wb_bundle_mesh, mesh);
}

static void describe_energies(struct wb_json *object, const struct wb_bundle_energies *e)
{
    WB_PUT(object, &bundle_energy_keys, struct wb_bundle_energies, e);
    wb_json_set_number(object, "imbalance_J", wb_bundle_imbalance(e));
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
    WB_PUT(object, &wb_simulated_bundle_keys, struct wb_bundle_result, h);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_KINETIC_LIMIT);
    wb_json_set_boolean(object, "limit_kept", !h->exceeded);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_MASS_SCALING);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_SELECTIVE);
    describe_setting(object, bundle->model, WB_BUNDLE_MODEL_PRECISION);
    if (h->n_rows > 0)
        describe_energies(wb_json_set_object(object, "energy"), &h->rows[h->n_rows - 1].energies);
    WB_PUT(object, &wb_simulated_bundle_keys, struct wb_bundle_result, h);
    if (!h->converged)
        wb_json_set_text(object, "problem", h->reason.text);
    WB_PUT(object, &wb_simulated_bundle_keys, struct wb_bundle_result, h);
    wb_json_set_integer(object, "threads", h->parts > 0 ? h->parts / wb_team_ranks() : 1);
    wb_json_set_integer(object, "ranks", wb_team_ranks());
    WB_PUT(object, &wb_simulated_bundle_keys, struct wb_simulated_bundle, bundle);
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
    WB_PUT(simulation, &wb_simulated_bundle_head_keys, struct wb_bundle_model, model);
    wb_json_set_text(simulation, "file", wb_file_name(model->path));
    wb_simulated_bundle_inputs(wb_json_set_object(simulation, "inputs"), model, head->mesh);
    wb_json_set_text(simulation, "law", "elastoplastic");
    WB_PUT(simulation, &wb_simulated_bundle_head_keys, struct wb_bundle_model, model);
    if (model->has_tape)
        describe_cohesion(simulation, &model->interface);
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
    wb_keys_put_tool(dataset->document, "wirebench");
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
