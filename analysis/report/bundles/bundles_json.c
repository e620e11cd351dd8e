#include "analysis/report/bundles/bundles_kind.h"

#include <math.h>
#include <stdio.h>

#include "analysis/report/numbers.h"
#include "base/units.h"

/* --- datasets --- */

static void put_state(struct wb_json *entry, const struct wb_simulation *wanted,
                      const struct wb_bundles_result *result)
{
    wb_simulation_describe(entry, wanted, &result->simulation);
    if (result->simulation.state != WB_SIMULATION_USABLE)
        return;
    wb_json_set_text(entry, "sha256", result->simulation.sha256);
    wb_json_set_text(entry, "tool_revision", result->simulation.revision);
    wb_json_set_number(entry, "cpu_s", result->simulation.cpu_s);
}

static void put_numbers(struct wb_json *entry, const struct wb_bundles_result *run)
{
    const struct wb_bundles_numbers *const n = &run->numbers;
    wb_json_set_number(entry, "elements", n->elements);
    wb_json_set_number(entry, "shells", n->shells);
    wb_json_set_number(entry, "steps", n->steps);
    wb_json_set_number(entry, "time_step_s", n->time_step);
    wb_json_set_number(entry, "duration_s", n->duration);
    wb_json_set_number(entry, "ns_per_element_step", n->ns);
    wb_json_set_number(entry, "kinetic_over_internal", n->kinetic);
    wb_json_set_number(entry, "artificial_over_internal", n->artificial);
    wb_json_set_number(entry, "imbalance_over_external", n->imbalance);
    wb_json_set_number(entry, "largest_strain", n->strain);
    wb_json_set_boolean(entry, "beyond_strain_limit", run->beyond);
    wb_json_set_number(entry, "largest_penetration_mm", n->penetration / WB_MM);
}

static void put_curves(struct wb_json *entry, const struct wb_bundles_result *run)
{
    const struct wb_curve *const curve = &run->curve;
    struct wb_json *const deflections = wb_json_set_array(entry, "deflection_mm");
    for (int i = 0; i < curve->n; i++)
        wb_json_append_number(deflections, curve->step * i / WB_MM);
    wb_json_set_number(entry, "F_max_N", curve->max_force);
    wb_numbers_put_list(entry, "force_N", curve->force, curve->n, 1.0);
    if (!run->published)
        return;
    wb_numbers_put_list(entry, "published_force_N", run->published, curve->n, 1.0);
    wb_numbers_put_list(entry, "error", run->error, run->n_published < curve->n ? 0 : curve->n,
                        1.0);
    wb_json_set_number(entry, "published_F_max_N", run->published_max);
    wb_json_set_number(entry, "rms", run->rms);
    wb_json_set_number(entry, "largest_error", run->max_error);
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
    wb_json_set_number(object, "friction_used", section->friction);
    wb_json_set_boolean(object, "friction_is_mean_of_decay", section->is_mean);
    wb_json_set_number(object, "rms", section->rms);
    wb_json_set_number(object, "largest_error", section->largest);
    wb_json_set_number(object, "tape_loosens_mm", section->loosens / WB_MM);
    struct wb_json *const lengths = wb_json_set_array(object, "elastic");
    for (int i = 0; i < WB_SECTION_RUN_LENGTHS; i++) {
        struct wb_json *const item = wb_json_append_object(lengths);
        wb_json_set_number(item, "length_mm", section->rigidity[i].length / WB_MM);
        wb_json_set_number(item, "EI_N_mm2", section->rigidity[i].rigidity / WB_NMM2);
        wb_json_set_number(item, "newmark_alpha_L", section->rigidity[i].alpha);
    }
    wb_numbers_put_list(object, "force_N", section->curve.force, section->curve.n, 1.0);
}

static void put_run(struct wb_json *list, const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_run *const wanted = &results->campaign->runs[index];
    const struct wb_bundles_result *const run = &results->runs[index];
    const struct wb_bundle_model *const m = wanted->model;
    const struct wb_setting *const rows = wb_bundle_model_run_settings;
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "name", wanted->name);
    wb_json_set_text(entry, "bundle", wanted->model_name);
    wb_json_set_text(entry, "inputs_sha256", wanted->dataset.inputs_sha256);
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
    put_numbers(entry, run);
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
    wb_json_set_number(entry, "fit_rms", fit->result.rms);
    wb_json_set_number(entry, "fit_largest_error", fit->result.max_error);
    wb_json_set_text(entry, "fit_stopped_because", wb_calibrate_end_text(fit->result.end));
    wb_json_set_integer(entry, "fit_beam_runs", fit->result.evaluations);
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
    wb_json_set_text(entry, "label", bundle->label);
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
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_text(entry, "limit", verdicts[i].key);
        wb_json_set_text(entry, "of", verdicts[i].label);
        wb_json_set_number(entry, "value", verdicts[i].value);
        wb_json_set_number(entry, "largest", verdicts[i].limit);
        wb_json_set_boolean(entry, "kept", verdicts[i].kept);
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
