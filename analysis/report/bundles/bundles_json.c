#include "analysis/report/bundles/bundles_kind.h"

#include <math.h>
#include <stdio.h>

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "analysis/report/numbers.h"
#include "base/units.h"

/* --- keys --- */

#define VERDICT(member) WB_AT(struct wb_verdict, member)
#define RESULT(member) WB_AT(struct wb_simulation_result, member)
#define RIGIDITY(member) WB_AT(struct wb_section_run_rigidity, member)
#define SECTION(member) WB_AT(struct wb_bundles_section, member)
#define FIT(member) WB_AT(struct wb_bundles_fit, member)
#define WANTED(member) WB_AT(struct wb_bundles_run, member)
#define RUN(member) WB_AT(struct wb_bundles_result, member)

static const struct wb_key verdict_rows[] = {
    {"limit", VERDICT(key), "key of the limit"},  {"of", VERDICT(label), "bundle or run"},
    {"value", VERDICT(value) | UNKNOWN, "value"}, {"largest", VERDICT(limit), "limit of the value"},
    {"kept", VERDICT(kept), "the limit is kept"},
};
static WB_KEYS(verdict, "verdict", "A limit and whether it is kept.");

static const struct wb_key beam_rows[] = {
    {"outer_diameter_mm", NUMBER, "outer diameter"},
    {.of = &wb_law_ludwik_keys},
    {"EI_N_mm2", NUMBER, "flexural rigidity"},
};
static WB_KEYS(beam, "beam", "A homogenised beam.");

static const struct wb_key dataset_rows[] = {
    {.of = &wb_simulation_state_keys},
    {"sha256", RESULT(sha256) | OPTIONAL, "SHA-256 of force_deflection.csv"},
    {"tool_revision", RESULT(revision) | OPTIONAL, "revision of the program that computed it"},
    {"cpu_s", RESULT(cpu_s) | UNKNOWN | OPTIONAL, "CPU time"},
};
static WB_KEYS(dataset, "bundle_dataset", "A dataset.");

static const struct wb_key bundle_rows[] = {
    {"label", WB_AT(struct wb_bundles_bundle, label), "name in the report"},
    {"group", TEXT, "group of the bundle"},
    {"decaying_friction", TEXT, "name of the run with decaying friction"},
    {"constant_friction", TEXT | OPTIONAL, "name of the run with constant friction"},
    {"packed_diameter_mm", NUMBER, "diameter of wires and tape"},
    {"EI_sliding_N_mm2", NUMBER, "elastic flexural rigidity of sliding wires"},
    {"EI_bonded_N_mm2", NUMBER, "elastic flexural rigidity of bonded wires"},
    {"published", OBJECT | OPTIONAL, "published beam", &beam_keys},
    {"fit_problem", TEXT | OPTIONAL, "why no beam was fitted"},
    {"fitted", OBJECT | OPTIONAL, "beam fitted to the run with decaying friction", &beam_keys},
    {"fit_rms", FIT(result.rms) | UNKNOWN | OPTIONAL, "RMS error of the fit over F_max"},
    {"fit_largest_error", FIT(result.max_error) | UNKNOWN | OPTIONAL,
     "largest error of the fit over F_max"},
    {"fit_stopped_because", TEXT | OPTIONAL, "why the search ended"},
    {"fit_beam_runs", FIT(result.evaluations) | OPTIONAL, "computations of the beam"},
    {"fitted_force_N", NUMBER | LIST | UNKNOWN | OPTIONAL,
     "force of the fitted beam at the run's deflections"},
    {"rod", OBJECT | OPTIONAL, "dataset of the published beam", &dataset_keys},
    {"cpu_of_rod_over_bundle", NUMBER | UNKNOWN | OPTIONAL,
     "CPU time of the beam over that of the bundle"},
};
static WB_KEYS(bundle, "report_bundle", "A bundle.");

static const struct wb_key elastic_rows[] = {
    {"length_mm", RIGIDITY(length), "length"},
    {"EI_N_mm2", RIGIDITY(rigidity) | UNKNOWN, "flexural rigidity at that length"},
    {"newmark_alpha_L", RIGIDITY(alpha) | UNKNOWN, "alpha L of Newmark's theory"},
};
static WB_KEYS(elastic, "section_rigidity", "The elastic rigidity at one length.");

static const struct wb_key section_rows[] = {
    {"problem", TEXT | OPTIONAL, "why the section model was not computed"},
    {"friction_used", SECTION(friction) | OPTIONAL, "friction coefficient"},
    {"friction_is_mean_of_decay", SECTION(is_mean) | OPTIONAL,
     "it is the geometric mean of a static and a kinetic coefficient"},
    {"rms", SECTION(rms) | UNKNOWN | OPTIONAL,
     "RMS difference from the run's curve over its F_max"},
    {"largest_error", SECTION(largest) | UNKNOWN | OPTIONAL, "largest difference over F_max"},
    {"tape_loosens_mm", SECTION(loosens) | UNKNOWN | OPTIONAL,
     "deflection from which the section model is too stiff, as the tape loosens; null: nowhere"},
    {"elastic", WB_FULL(struct wb_bundles_section, rigidity) | OPTIONAL, "elastic rigidity",
     &elastic_keys},
    {"force_N", WB_POINTER(struct wb_bundles_section, curve.force, curve.n) | UNKNOWN | OPTIONAL,
     "force at the run's deflections"},
};
static WB_KEYS(section, "section_model", "The section model of the same bundle.");

static const struct wb_setting_table friction_setting = {wb_bundle_model_friction_setting, 1};
static const struct wb_setting_table cohesion_setting = {wb_bundle_model_cohesion_setting, 1};

static const struct wb_key run_rows[] = {
    {"name", WANTED(name), "name of the run"},
    {"bundle", WANTED(model_name), "name of the bundle's file"},
    {"inputs_sha256", WANTED(dataset.inputs_sha256), "SHA-256 of the inputs"},
    {"mesh", TEXT, "name of the mesh"},
    {.settings = &friction_setting},
    {.settings = &cohesion_setting},
    {"strand_mm", NUMBER, "length of the strand; 0: a vertical force"},
    {"weight", FLAG, "weight acts"},
    {"mass_scaling", NUMBER, "mass scaling f_m of eq. 29"},
    {"selective_mass_scaling", NUMBER, "selective mass scaling beta; 1: none"},
    {.of = &dataset_keys},
    {"section_model", OBJECT | OPTIONAL, "section model", &section_keys},
    {"elements", RUN(numbers.elements) | UNKNOWN | OPTIONAL, "number of hexahedra"},
    {"shells", RUN(numbers.shells) | UNKNOWN | OPTIONAL, "number of shells"},
    {"steps", RUN(numbers.steps) | UNKNOWN | OPTIONAL, "time steps of the last attempt"},
    {"time_step_s", RUN(numbers.time_step) | UNKNOWN | OPTIONAL, "time step"},
    {"duration_s", RUN(numbers.duration) | UNKNOWN | OPTIONAL, "duration of a loading"},
    {"ns_per_element_step", RUN(numbers.ns) | UNKNOWN | OPTIONAL,
     "CPU time over hexahedra and steps", .unit = "ns"},
    {"kinetic_over_internal", RUN(numbers.kinetic) | UNKNOWN | OPTIONAL,
     "largest kinetic over internal energy"},
    {"artificial_over_internal", RUN(numbers.artificial) | UNKNOWN | OPTIONAL,
     "largest artificial over internal energy"},
    {"imbalance_over_external", RUN(numbers.imbalance) | UNKNOWN | OPTIONAL,
     "largest imbalance over external work"},
    {"largest_strain", RUN(numbers.strain) | UNKNOWN | OPTIONAL, "largest logarithmic strain"},
    {"beyond_strain_limit", RUN(beyond) | OPTIONAL,
     "a strain exceeds 5 % in wires or 10 % in the tape"},
    {"largest_penetration_mm", RUN(numbers.penetration) | UNKNOWN | OPTIONAL,
     "largest penetration of wires"},
    {"deflection_mm", NUMBER | LIST | OPTIONAL, "deflections of the curves"},
    {"F_max_N", RUN(curve.max_force) | OPTIONAL, "largest force of the run"},
    {"force_N", WB_POINTER(struct wb_bundles_result, curve.force, curve.n) | UNKNOWN | OPTIONAL,
     "force of the run"},
    {"published_force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "force of the published beam"},
    {"error", NUMBER | LIST | UNKNOWN | OPTIONAL, "difference over `published_F_max_N`"},
    {"published_F_max_N", RUN(published_max) | UNKNOWN | OPTIONAL,
     "largest force of the published beam"},
    {"rms", RUN(rms) | UNKNOWN | OPTIONAL, "RMS of `error`"},
    {"largest_error", RUN(max_error) | UNKNOWN | OPTIONAL, "largest of `error`"},
};
static WB_KEYS(run, "report_run", "A run; the keys from `elements` on are of a used dataset.");

static const struct wb_key wb_bundles_json_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"limits", OBJECT | LIST, "limits of the campaign", &verdict_keys},
    {"bundles", OBJECT | LIST, "bundles", &bundle_keys},
    {"runs", OBJECT | LIST, "runs", &run_keys},
};
WB_KEYS(wb_bundles_json, "report_of_bundles", "The report of a campaign of bundles.");

/* --- datasets --- */

static void put_state(struct wb_json *entry, const struct wb_simulation *wanted,
                      const struct wb_bundles_result *result)
{
    wb_simulation_describe(entry, wanted, &result->simulation);
    if (result->simulation.state != WB_SIMULATION_USABLE)
        return;
    WB_PUT(entry, &dataset_keys, struct wb_simulation_result, &result->simulation);
}

static void put_curves(struct wb_json *entry, const struct wb_bundles_result *run)
{
    const struct wb_curve *const curve = &run->curve;
    struct wb_json *const deflections = wb_json_set_array(entry, "deflection_mm");
    for (int i = 0; i < curve->n; i++)
        wb_json_append_number(deflections, curve->step * i / WB_MM);
    WB_PUT(entry, &run_keys, struct wb_bundles_result, run);
    if (!run->published)
        return;
    wb_numbers_put_list(entry, "published_force_N", run->published, curve->n, 1.0);
    wb_numbers_put_list(entry, "error", run->error, run->n_published < curve->n ? 0 : curve->n,
                        1.0);
    WB_PUT(entry, &run_keys, struct wb_bundles_result, run);
}

static void put_section(struct wb_json *entry, const struct wb_bundles_section *section)
{
    if (section->state == WB_SIMULATION_NOT_WANTED)
        return;
    struct wb_json *const object = wb_json_set_object(entry, "section_model");
    if (section->state != WB_SIMULATION_USABLE) {
        wb_json_set_text(object, "problem", wb_text_string(&section->problem));
        return;
    }
    WB_PUT(object, &section_keys, struct wb_bundles_section, section);
}

static void put_run(struct wb_json *list, const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_run *const wanted = &results->campaign->runs[index];
    const struct wb_bundles_result *const run = &results->runs[index];
    const struct wb_bundle_model *const m = wanted->model;
    const struct wb_setting *const rows = wb_bundle_model_run_settings;
    struct wb_json *const entry = wb_json_append_object(list);
    WB_PUT(entry, &run_keys, struct wb_bundles_run, wanted);
    wb_json_set_text(entry, "mesh", wanted->mesh->name);
    wb_setting_set_json(wb_bundle_model_friction_setting, &m->interface, entry);
    wb_setting_set_json(wb_bundle_model_cohesion_setting, &m->interface, entry);
    wb_json_set_number(entry, "strand_mm", m->loads.strand_length / WB_MM);
    wb_json_set_boolean(entry, "weight", m->loads.weight);
    wb_setting_set_json(&rows[WB_BUNDLE_MODEL_MASS_SCALING], &m->run, entry);
    wb_setting_set_json(&rows[WB_BUNDLE_MODEL_SELECTIVE], &m->run, entry);
    put_state(entry, &wanted->dataset, run);
    put_section(entry, &results->sections[index]);
    if (run->simulation.state != WB_SIMULATION_USABLE)
        return;
    WB_PUT(entry, &run_keys, struct wb_bundles_result, run);
    put_curves(entry, run);
}

/* --- bundles --- */

static void put_beam(struct wb_json *object, const char *key, const struct wb_material *material,
                     double diameter)
{
    struct wb_json *const entry = wb_json_set_object(object, key);
    wb_json_set_number(entry, "outer_diameter_mm", diameter / WB_MM);
    wb_numbers_put_properties(entry, material);
    wb_json_set_number(entry, "EI_N_mm2",
                       wb_bundles_results_rigidity(material->youngs_modulus, diameter) / WB_NMM2);
}

static void put_fit(struct wb_json *entry, const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_fit *const fit = &results->fits[index];
    if (fit->state != WB_SIMULATION_USABLE) {
        wb_json_set_text(entry, "fit_problem", wb_text_string(&fit->problem));
        return;
    }
    const struct wb_bundles_result *const run = &results->runs[bundle->dynamic];
    put_beam(entry, "fitted", &fit->result.material, run->simulation.dataset.info.outer_diameter);
    WB_PUT(entry, &bundle_keys, struct wb_bundles_fit, fit);
    wb_json_set_text(entry, "fit_stopped_because", wb_calibrate_end_text(fit->result.end));
    WB_PUT(entry, &bundle_keys, struct wb_bundles_fit, fit);
    wb_numbers_put_list(entry, "fitted_force_N", fit->force, run->curve.n, 1.0);
}

static void put_bundle(struct wb_json *list, const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_bundle *const bundle = &campaign->bundles[index];
    const struct wb_bundles_run *const run = &campaign->runs[bundle->dynamic];
    const struct wb_bundle_model *const m = run->model;
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(m);
    const struct wb_wire *const published = wb_bundles_published(run);
    struct wb_json *const entry = wb_json_append_object(list);
    WB_PUT(entry, &bundle_keys, struct wb_bundles_bundle, bundle);
    wb_json_set_text(entry, "group", campaign->groups[bundle->group].label);
    wb_json_set_text(entry, "decaying_friction", run->name);
    if (bundle->constant >= 0)
        wb_json_set_text(entry, "constant_friction", campaign->runs[bundle->constant].name);
    wb_json_set_number(entry, "packed_diameter_mm", wb_bundle_model_diameter(m) / WB_MM);
    wb_json_set_number(entry, "EI_sliding_N_mm2", rigidity.sliding[0] / WB_NMM2);
    wb_json_set_number(entry, "EI_bonded_N_mm2", rigidity.bonded[0] / WB_NMM2);
    if (published)
        put_beam(entry, "published", &published->material, published->outer_diameter);
    put_fit(entry, results, index);
    if (!bundle->has_rod)
        return;
    put_state(wb_json_set_object(entry, "rod"), &bundle->rod, &results->rods[index]);
    wb_json_set_number(entry, "cpu_of_rod_over_bundle", wb_bundles_results_cost(results, index));
}

/* --- all of it --- */

static void put_verdicts(struct wb_json *root, const struct wb_bundles_results *results)
{
    struct wb_verdict verdicts[WB_BUNDLES_VERDICTS];
    const int n = wb_bundles_results_judge(results, verdicts);
    struct wb_json *const list = wb_json_set_array(root, "limits");
    for (int i = 0; i < n; i++) {
        WB_PUT(wb_json_append_object(list), &verdict_keys, struct wb_verdict, &verdicts[i]);
    }
}

struct wb_json *wb_bundles_json_build(const void *context)
{
    const struct wb_bundles_results *const results = context;
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_json *const root =
        wb_numbers_create(&campaign->head, "simulation", &results->outcome);
    put_verdicts(root, results);
    struct wb_json *const bundles = wb_json_set_array(root, "bundles");
    for (int i = 0; i < campaign->n_bundles; i++)
        put_bundle(bundles, results, i);
    struct wb_json *const runs = wb_json_set_array(root, "runs");
    for (int i = 0; i < campaign->n_runs; i++)
        put_run(runs, results, i);
    return root;
}
