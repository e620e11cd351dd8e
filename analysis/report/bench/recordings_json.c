#include "analysis/report/bench/recordings_kind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/bench/recordings_draw.h"
#include "analysis/report/numbers.h"
#include "analysis/validation/validate_json.h"
#include "base/units.h"

static const char *state_text(enum wb_recordings_results_state state)
{
    static const char *const texts[] = {"not wanted", "missing", "failed", "done"};
    return texts[state];
}

static void put_settings(struct wb_json *root, const struct wb_recordings *campaign)
{
    const struct wb_calibrate_settings meant = wb_calibrate_settings_meant(&campaign->head.fit);
    struct wb_json *const settings = wb_json_set_object(root, "settings");
    for (size_t i = 0; i < wb_calibrate_table.n; i++) {
        const struct wb_setting *const row = &wb_calibrate_table.rows[i];
        if (wb_setting_applies(row, WB_CALIBRATE_REPORT))
            wb_setting_set_json(row, &meant, settings);
    }
    struct wb_json *const limits = wb_json_set_object(root, "limits");
    if (campaign->limit[WB_RECORDINGS_CALIBRATION] > 0.0)
        wb_json_set_number(limits, "calibration_rms_max", campaign->limit[0]);
    if (campaign->limit[WB_RECORDINGS_VALIDATION] > 0.0)
        wb_json_set_number(limits, "validation_rms_max", campaign->limit[1]);
}

static void put_test(struct wb_json *list, const struct wb_recordings_results_wire *wire,
                     const struct wb_recordings_results_test *test,
                     enum wb_recordings_purpose purpose)
{
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "name", test->wanted->name);
    wb_json_set_text(entry, "wire", wire->wanted->product.name);
    wb_json_set_text(entry, "purpose", wb_recordings_purposes[purpose]);
    wb_json_set_boolean(entry, "used", test->usable);
    if (test->wanted->seed >= 0)
        wb_json_set_integer(entry, "seed", test->wanted->seed);
    const char *const sha256 = test->sha256[0] ? test->sha256 : test->wanted->sha256;
    if (sha256[0])
        wb_json_set_text(entry, "sha256", sha256);
    if (test->wanted->excluded.is_excluded) {
        wb_index_exclusion_set_json(&test->wanted->excluded, entry);
        return;
    }
    if (!test->usable) {
        wb_json_set_text(entry, "problem", wb_text_string(&test->problem));
        return;
    }
    const struct wb_test_info *const info = &test->dataset.info;
    wb_json_set_integer(entry, "sample", info->sample);
    wb_json_set_number(entry, "length_mm", info->length / WB_MM);
    wb_json_set_boolean(entry, "virtual_rig", test->is_virtual);
    wb_json_set_text(entry, "start_utc", test->start_utc);
    wb_json_set_text(entry, "tool_revision", test->tool_revision);
    wb_json_set_text(entry, "operator", test->operator_name);
    wb_json_set_number(entry, "bow_mm", wb_dataset_bow(info) / WB_MM);
    static const char *const parts[] = {"corrections", "checks", "warnings"};
    for (int k = 0; k < 3; k++) {
        const struct wb_json *const part = wb_json_get(test->dataset.document, parts[k]);
        if (part)
            wb_json_set_copy(entry, parts[k], part);
    }
}

static void put_prediction(struct wb_json *object, const char *key,
                           const struct wb_prediction *prediction)
{
    struct wb_json *const entry = wb_json_set_object(object, key);
    wb_json_set_number(entry, "rms_over_F_max", prediction->rms);
    wb_json_set_number(entry, "rms_from_5mm_over_F_max", prediction->rms_from_5mm);
    wb_json_set_number(entry, "largest_error_over_F_max", prediction->max_error);
    wb_json_set_integer(entry, "points_reached", prediction->n_reached);
    wb_numbers_put_list(entry, "force_mN", prediction->force, prediction->n, WB_MN);
    wb_numbers_put_list(entry, "error_over_F_max", prediction->error, prediction->n, 1.0);
}

static void put_comparison(struct wb_json *object, const struct wb_validate_result *result,
                           double scatter, double residual)
{
    const struct wb_curve *const curve = &result->curve;
    wb_json_set_integer(object, "samples", curve->n_samples);
    wb_json_set_number(object, "length_mm", result->info.length / WB_MM);
    wb_json_set_number(object, "F_max_mN", curve->max_force / WB_MN);
    wb_json_set_number(object, "max_deflection_mm", curve->max_deflection / WB_MM);
    wb_json_set_number(object, "scatter_rms_over_F_max",
                       curve->n_samples > 1 ? scatter : (double)NAN);
    wb_json_set_number(object, "residual_scatter_rms_over_F_max",
                       curve->n_samples > 1 ? residual : (double)NAN);
    wb_json_set_number(object, "shape_rms_mm", result->shape_rms / WB_MM);
    wb_json_set_number(object, "shape_largest_mm", result->shape_max / WB_MM);
    wb_json_set_integer(object, "shape_points", result->n_shape_points);
    wb_json_set_number(object, "mean_bow_mm", wb_dataset_bow(&result->info) / WB_MM);
    struct wb_json *const measured = wb_json_set_object(object, "measured");
    struct wb_json *const deflection = wb_json_set_array(measured, "deflection_mm");
    for (int i = 0; i < curve->n; i++)
        wb_json_append_number(deflection, i * curve->step / WB_MM);
    wb_numbers_put_list(measured, "force_mN", curve->force, curve->n, WB_MN);
    wb_numbers_put_list(measured, "lowest_mN", curve->low, curve->n, WB_MN);
    wb_numbers_put_list(measured, "highest_mN", curve->high, curve->n, WB_MN);
    wb_numbers_put_list(measured, "standard_deviation_mN", curve->deviation, curve->n, WB_MN);
    put_prediction(object, "elastoplastic", &result->elastoplastic);
    put_prediction(object, "linear_elastic", &result->elastic);
}

static void put_validation(struct wb_json *object, const struct wb_validate_result *validation)
{
    put_comparison(object, validation, validation->scatter_rms, validation->residual_scatter_rms);
    wb_json_set_number(object, "rms_of_perfect_model_over_F_max", validation->expected_rms);
    wb_json_set_number(object, "rms_of_perfect_model_95_over_F_max", validation->expected_rms_95);
    wb_json_set_number(object, "share_explained_by_scatter", validation->scatter_share);
    wb_validate_json_put_cycles(object, validation);
}

static void put_uncertainties(struct wb_json *object, const struct wb_calibrate_result *result)
{
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    struct wb_json *const entry = wb_json_set_object(object, "standard_uncertainties");
    wb_json_set_number(entry, "youngs_modulus_MPa", result->deviation[0] / WB_MPA);
    wb_json_set_number(entry, "yield_stress_MPa", result->deviation[1] / WB_MPA);
    wb_json_set_number(entry, "strength_coefficient_factor", exp(result->deviation[2]));
    wb_json_set_number(entry, "hardening_exponent", result->deviation[3]);
    wb_json_set_boolean(object, "bow_corrected", result->bow_corrected);
    struct wb_json *const list = wb_json_set_array(object, "remarks");
    const int n = wb_calibrate_remarks(result, remarks);
    for (int i = 0; i < n; i++)
        wb_json_append_text(list, remarks[i]);
}

static void put_search(struct wb_json *object, const struct wb_calibrate_result *c)
{
    struct wb_json *const search = wb_json_set_object(object, "search");
    wb_json_set_number(search, "first_strength_coefficient_MPa",
                       c->first_strength_coefficient / WB_MPA);
    wb_json_set_number(search, "first_hardening_exponent", c->first_hardening_exponent);
    wb_json_set_text(search, "stopped_because", wb_calibrate_end_text(c->end));
    wb_json_set_boolean(search, "restarted", c->restarted);
    wb_json_set_number(search, "restart_moved", c->restart_moved);
    wb_json_set_integer(search, "beam_runs", c->evaluations);
    wb_json_set_integer(search, "beam_runs_not_converged", c->failed_evaluations);
    struct wb_json *const k = wb_json_set_array(search, "strength_coefficient_MPa");
    struct wb_json *const n = wb_json_set_array(search, "hardening_exponent");
    struct wb_json *const error = wb_json_set_array(search, "error_over_F_max");
    struct wb_json *const size = wb_json_set_array(search, "simplex_size");
    for (int i = 0; i < c->n_path; i++) {
        wb_json_append_number(k, c->path[i].strength_coefficient / WB_MPA);
        wb_json_append_number(n, c->path[i].hardening_exponent);
        wb_json_append_number(error, c->path[i].error);
        wb_json_append_number(size, c->path[i].size);
    }
}

static void put_calibration(struct wb_json *object, const struct wb_recordings_results_wire *wire)
{
    const struct wb_calibrate_result *const c = &wire->calibration;
    wb_numbers_put_properties(wb_json_set_object(object, "properties"), &c->material);
    put_uncertainties(object, c);
    wb_json_set_number(object, "rms_over_F_max", c->rms);
    wb_json_set_number(object, "largest_error_over_F_max", c->max_error);
    put_comparison(object, &wire->steps[WB_RECORDINGS_CALIBRATION].result, c->scatter_rms,
                   c->residual_scatter_rms);
    put_search(object, c);
}

/* A step's object: how it ended, and why not well. False: there is nothing more to put. */
static bool put_state(struct wb_json *of, enum wb_recordings_results_state state,
                      const struct wb_text *problem)
{
    wb_json_set_text(of, "state", state_text(state));
    if (state == WB_RECORDINGS_MISSING || state == WB_RECORDINGS_FAILED)
        wb_json_set_text(of, "problem", wb_text_string(problem));
    return state == WB_RECORDINGS_DONE;
}

static void put_pooled(struct wb_json *of, const struct wb_recordings_results *results,
                       const struct wb_recordings_cycle *cycle)
{
    struct wb_json *const pooled =
        wb_json_set_object(of, "flexural_rigidity_N_mm2_pooled_over_wires");
    double low, high;
    wb_recordings_cycle_interval(&results->pool, cycle, &low, &high);
    wb_json_set_number(pooled, "low", low / WB_NMM2);
    wb_json_set_number(pooled, "high", high / WB_NMM2);
    wb_json_set_number(pooled, "deviation_of_logarithm", results->pool.deviation);
    wb_json_set_integer(pooled, "degrees_of_freedom", results->pool.degrees);
}

static void put_cycle(struct wb_json *entry, const struct wb_recordings_results *results,
                      const struct wb_recordings_results_wire *wire)
{
    const enum wb_recordings_results_state *const states = wire->cycle_states;
    if (states[WB_RECORDINGS_CALIBRATION] == WB_RECORDINGS_NOT_WANTED)
        return;
    struct wb_json *const of = wb_json_set_object(entry, "cycle");
    if (put_state(of, states[WB_RECORDINGS_CALIBRATION], &wire->cycle_problems[0])) {
        wb_recordings_cycle_put(of, &wire->cycle);
        if (results->pool.degrees > 0)
            put_pooled(of, results, &wire->cycle);
    }
    if (states[WB_RECORDINGS_VALIDATION] == WB_RECORDINGS_NOT_WANTED)
        return;
    struct wb_json *const prediction = wb_json_set_object(of, "prediction");
    if (put_state(prediction, states[WB_RECORDINGS_VALIDATION], &wire->cycle_problems[1]))
        put_validation(prediction, &wire->prediction);
}

/* As a laboratory's report has it. */
static void put_verdict(struct wb_json *of, const struct wb_recordings *campaign,
                        const struct wb_recordings_results_wire *wire,
                        enum wb_recordings_purpose purpose)
{
    wb_json_set_number(of, "rms_uncertainty_95_over_F_max",
                       wb_recordings_results_uncertainty(wire, purpose));
    if (campaign->limit[purpose] > 0.0)
        wb_json_set_boolean(of, "limit_kept", wb_recordings_results_keeps(campaign, wire, purpose));
}

static void put_wire(struct wb_json *list, const struct wb_recordings_results *results,
                     const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_wire *const wanted = wire->wanted;
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "wire", wanted->product.name);
    wb_json_set_text(entry, "label", wanted->label);
    wb_json_set_number(entry, "conductor_diameter_mm", wanted->product.conductor_diameter / WB_MM);
    wb_json_set_number(entry, "outer_diameter_mm", wanted->product.outer_diameter / WB_MM);
    wb_json_set_number(entry, "density_g_cm3", wanted->product.density / WB_G_PER_CM3);
    if (wanted->has_reference) {
        struct wb_json *const published = wb_json_set_object(entry, "published");
        wb_numbers_put_properties(published, &wanted->reference);
        wb_json_set_text(published, "source", wanted->reference_source);
    }
    for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
        const struct wb_recordings_results_step *const step = &wire->steps[k];
        struct wb_json *const of = wb_json_set_object(entry, wb_recordings_purposes[k]);
        if (!put_state(of, step->state, &step->problem))
            continue;
        if (k == WB_RECORDINGS_CALIBRATION)
            put_calibration(of, wire);
        else
            put_validation(of, &step->result);
        if (results->campaign->head.laboratory.is_given)
            put_verdict(of, results->campaign, wire, (enum wb_recordings_purpose)k);
    }
    put_cycle(entry, results, wire);
}

struct wb_json *wb_recordings_json_build(const void *context)
{
    const struct wb_recordings_results *const results = context;
    const struct wb_recordings *const campaign = results->campaign;
    struct wb_json *const root = wb_json_create();
    wb_numbers_put_title(root, campaign->head.title, wb_recordings_draw_measured(results));
    wb_json_set_boolean(root, "virtual_rig", results->any_virtual);
    wb_numbers_put_program(root);
    wb_numbers_put_campaign(root, &campaign->head);
    put_settings(root, campaign);
    wb_numbers_put_outcome(root, &results->outcome);
    struct wb_json *const recordings = wb_json_set_array(root, "recordings");
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire;
    enum wb_recordings_purpose purpose;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, &purpose)); i++)
        put_test(recordings, wire, test, purpose);
    struct wb_json *const wires = wb_json_set_array(root, "wires");
    for (int i = 0; i < results->n_wires; i++)
        put_wire(wires, results, &results->wires[i]);
    return root;
}
