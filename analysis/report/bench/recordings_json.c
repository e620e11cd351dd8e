#include "analysis/report/bench/recordings_kind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/align/align_keys.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "analysis/report/bench/recordings_draw.h"
#include "analysis/report/numbers.h"
#include "analysis/validation/validate_json.h"
#include "base/units.h"

/* --- keys --- */

#define TEST(member) WB_AT(struct wb_recordings_results_test, member)
#define WIRE(member) WB_AT(struct wb_recordings_wire, member)
#define CURVE_LIST(member) WB_POINTER(struct wb_curve, member, n)
#define PREDICTION(member) WB_AT(struct wb_prediction, member)
#define RESULT(member) WB_AT(struct wb_validate_result, member)
#define FITTED(member) WB_AT(struct wb_calibrate_result, member)

static const struct wb_key settings_rows[] = {
    {.settings = &wb_calibrate_table,
     .applies = WB_CALIBRATE_REPORT,
     WB_HERE(struct wb_calibrate_settings)},
};
static WB_KEYS(settings, "report_settings", "Settings of the calibration.");

static const struct wb_key limits_rows[] = {
    {"calibration_rms_max", NUMBER | OPTIONAL, "limit of the RMS of calibrations over F_max"},
    {"validation_rms_max", NUMBER | OPTIONAL, "limit of the RMS of validations over F_max"},
};
static WB_KEYS(limits, "report_limits", "Limits of the campaign.");

static const struct wb_key recording_rows[] = {
    {"name", WB_AT(struct wb_recordings_test, name), "name of the recording"},
    {"wire", TEXT, "name of the product"},
    {"purpose", TEXT, "use of the recording", .choices = "calibration|validation"},
    {"used", TEST(usable), "the recording is used"},
    {"seed", INTEGER | OPTIONAL, "seed of the virtual rig"},
    {"sha256", TEXT | OPTIONAL, "SHA-256 of the uncompressed recording"},
    {"excluded", OBJECT | OPTIONAL, "exclusion of the test", &wb_common_excluded_keys},
    {"problem", TEXT | OPTIONAL, "why the recording is not used"},
    {"sample", TEST(dataset.info.sample) | OPTIONAL, "number of the piece"},
    {"length_mm", TEST(dataset.info.length) | OPTIONAL, "free length"},
    {"virtual_rig", TEST(is_virtual) | OPTIONAL, "the data come from a virtual rig"},
    {"start_utc", TEST(start_utc) | OPTIONAL, "start of the test"},
    {"tool_revision", TEST(tool_revision) | OPTIONAL, "revision of the program that recorded"},
    {"operator", TEST(operator_name) | OPTIONAL, "operator"},
    {"bow_mm", NUMBER | OPTIONAL, "natural offset of the tip"},
    {"corrections", OBJECT | LIST | OPTIONAL, "as in dataset.json", &wb_align_correction_keys},
    {"checks", OBJECT | OPTIONAL, "as in dataset.json", &wb_align_checks_keys},
    {"warnings", TEXT | LIST | OPTIONAL, "as in dataset.json"},
};
static WB_KEYS(recording, "report_recording",
               "A recording; the keys from `sample` on are of a used one.");

static const struct wb_key published_rows[] = {
    {.of = &wb_law_ludwik_keys},
    {"source", WIRE(reference_source), "source of the values"},
};
static WB_KEYS(published, "published", "Published properties of a wire.");

static const struct wb_key measured_rows[] = {
    {"deflection_mm", NUMBER | LIST, "deflections of the curves"},
    {"force_mN", CURVE_LIST(force) | UNKNOWN, "mean force of the specimens"},
    {"lowest_mN", CURVE_LIST(low) | UNKNOWN, "lowest force of the specimens"},
    {"highest_mN", CURVE_LIST(high) | UNKNOWN, "highest force of the specimens"},
    {"standard_deviation_mN", CURVE_LIST(deviation) | UNKNOWN,
     "standard deviation of the force between specimens"},
};
static WB_KEYS(measured, "measured_curve", "The mean curve of the specimens.");

static const struct wb_key computed_rows[] = {
    {"rms_over_F_max", PREDICTION(rms) | UNKNOWN, "RMS error over F_max"},
    {"rms_from_5mm_over_F_max", PREDICTION(rms_from_5mm) | UNKNOWN,
     "the same of deflections from 5 mm on"},
    {"largest_error_over_F_max", PREDICTION(max_error) | UNKNOWN, "largest error over F_max"},
    {"points_reached", PREDICTION(n_reached), "deflections that the computation reached"},
    {"force_mN", WB_POINTER(struct wb_prediction, force, n) | UNKNOWN, "computed force"},
    {"error_over_F_max", WB_POINTER(struct wb_prediction, error, n) | UNKNOWN,
     "error of the force over F_max"},
};
static WB_KEYS(computed, "computed_curve", "A computed curve.");

static const struct wb_key comparison_rows[] = {
    {"samples", RESULT(curve.n_samples) | OPTIONAL, "number of specimens"},
    {"length_mm", RESULT(info.length) | OPTIONAL, "free length"},
    {"F_max_mN", RESULT(curve.max_force) | OPTIONAL, "F_max, the largest force of the mean curve"},
    {"max_deflection_mm", RESULT(curve.max_deflection) | OPTIONAL,
     "largest deflection of the mean curve"},
    {"scatter_rms_over_F_max", NUMBER | UNKNOWN | OPTIONAL,
     "scatter between specimens over F_max; null with one specimen"},
    {"residual_scatter_rms_over_F_max", NUMBER | UNKNOWN | OPTIONAL,
     "part of the scatter that remains with the natural shape of each specimen"},
    {"shape_rms_mm", RESULT(shape_rms) | UNKNOWN | OPTIONAL,
     "RMS distance of the markers from the computed wire"},
    {"shape_largest_mm", RESULT(shape_max) | UNKNOWN | OPTIONAL, "largest such distance"},
    {"shape_points", RESULT(n_shape_points) | OPTIONAL, "number of markers' places compared"},
    {"mean_bow_mm", NUMBER | OPTIONAL, "mean natural offset of the tip"},
    {"measured", OBJECT | OPTIONAL, "mean curve of the specimens", &measured_keys},
    {"elastoplastic", RESULT(elastoplastic) | OPTIONAL, "curve of the elastoplastic wire",
     &computed_keys},
    {"linear_elastic", RESULT(elastic) | OPTIONAL, "curve of the linear elastic wire",
     &computed_keys},
};
static WB_KEYS(comparison, "comparison_keys", "");

static const struct wb_key state_rows[] = {
    {"state", TEXT, "whether there is a result", .choices = "not wanted|missing|failed|done"},
    {"problem", TEXT | OPTIONAL, "why it is missing or failed"},
};
static WB_KEYS(state, "state_keys", "");

static const struct wb_key verdict_rows[] = {
    {"rms_uncertainty_95_over_F_max", NUMBER | UNKNOWN | OPTIONAL,
     "in reports of a laboratory: expanded uncertainty (95 %) of the RMS"},
    {"limit_kept", FLAG | OPTIONAL, "in reports of a laboratory: the limit is kept"},
};
static WB_KEYS(verdict, "laboratory_verdict", "");

static const struct wb_key uncertainties_rows[] = {
    {"youngs_modulus_MPa", FITTED(deviation[0]) | UNKNOWN, "of E"},
    {"yield_stress_MPa", FITTED(deviation[1]) | UNKNOWN, "of sigma_Y"},
    {"strength_coefficient_factor", NUMBER | UNKNOWN,
     "K lies between K divided by this factor and K times this factor"},
    {"hardening_exponent", FITTED(deviation[3]) | UNKNOWN, "of n"},
};
static WB_KEYS(uncertainties, "standard_uncertainties",
               "Standard uncertainties from the scatter between specimens.");

static const struct wb_key search_rows[] = {
    {"first_strength_coefficient_MPa", FITTED(first_strength_coefficient), "initial guess of K"},
    {"first_hardening_exponent", FITTED(first_hardening_exponent), "initial guess of n"},
    {"stopped_because", TEXT, "why the search ended"},
    {"restarted", FITTED(restarted), "the search was started again from the optimum"},
    {"restart_moved", FITTED(restart_moved) | UNKNOWN,
     "largest relative change of K or n by the restart"},
    {"beam_runs", FITTED(evaluations), "computations of the beam"},
    {"beam_runs_not_converged", FITTED(failed_evaluations), "computations that did not converge"},
    {"strength_coefficient_MPa", NUMBER | LIST, "K of each iteration"},
    {"hardening_exponent", NUMBER | LIST, "n of each iteration"},
    {"error_over_F_max", NUMBER | LIST | UNKNOWN, "error of each iteration"},
    {"simplex_size", NUMBER | LIST | UNKNOWN, "size of the simplex in each iteration"},
};
static WB_KEYS(search, "search", "The search for K and n.");

static const struct wb_key calibration_rows[] = {
    {.of = &state_keys},
    {"properties", OBJECT | OPTIONAL, "E, sigma_Y, K and n", &wb_law_ludwik_keys},
    {"standard_uncertainties", OBJECT | OPTIONAL, "their standard uncertainties",
     &uncertainties_keys},
    {"bow_corrected", FITTED(bow_corrected) | OPTIONAL,
     "E and sigma_Y were corrected for the specimens' bows"},
    {"remarks", TEXT | LIST | OPTIONAL, "remarks on the properties"},
    {"rms_over_F_max", FITTED(rms) | OPTIONAL, "RMS error of the fit over F_max"},
    {"largest_error_over_F_max", FITTED(max_error) | OPTIONAL,
     "largest error of the fit over F_max"},
    {.of = &comparison_keys},
    {"search", OBJECT | OPTIONAL, "search for K and n", &search_keys},
    {.of = &verdict_keys},
};
static WB_KEYS(calibration, "report_calibration",
               "The calibration of a wire; all keys are present where it is done.");

static const struct wb_key expected_rows[] = {
    {"rms_of_perfect_model_over_F_max", RESULT(expected_rms) | UNKNOWN | OPTIONAL,
     "RMS error expected from specimen scatter alone"},
    {"rms_of_perfect_model_95_over_F_max", RESULT(expected_rms_95) | UNKNOWN | OPTIONAL,
     "RMS error that specimen scatter alone exceeds in one of twenty validations"},
    {"share_explained_by_scatter", RESULT(scatter_share) | UNKNOWN | OPTIONAL,
     "square of the expected RMS over that of the RMS found, at most 1"},
};
static WB_KEYS(expected, "expected_keys", "");

static const struct wb_key validation_rows[] = {
    {.of = &state_keys},    {.of = &comparison_keys},
    {.of = &expected_keys}, {.of = &wb_validate_json_keys},
    {.of = &verdict_keys},
};
static WB_KEYS(validation, "report_validation",
               "The validation of a wire; keys from `samples` on are present if done.");

static const struct wb_key pooled_rows[] = {
    {"low", NUMBER | UNKNOWN, "lower end of the 95 % confidence interval", .unit = "N mm2"},
    {"high", NUMBER | UNKNOWN, "upper end of that interval", .unit = "N mm2"},
    {"deviation_of_logarithm", WB_AT(struct wb_recordings_cycle_pool, deviation) | UNKNOWN,
     "pooled standard deviation of ln EI"},
    {"degrees_of_freedom", WB_AT(struct wb_recordings_cycle_pool, degrees),
     "its degrees of freedom"},
};
static WB_KEYS(pooled, "pooled_interval",
               "The interval of EI with the scatter of all wires' specimens.");

/* Of a cycle that is done, or not. */
static const struct wb_key prediction_rows[] = {
    {"prediction", OBJECT | OPTIONAL, "validation of this law", &validation_keys},
};
static WB_KEYS(prediction, "prediction_key", "");

static const struct wb_key cycle_done_rows[] = {
    {"state", TEXT, "the calibration is done", .choices = "done"},
    {.of = &wb_recordings_cycle_keys},
    {"flexural_rigidity_N_mm2_pooled_over_wires", OBJECT | OPTIONAL,
     "EI with the scatter of all wires' specimens", &pooled_keys, .unit = "N mm2"},
    {.of = &prediction_keys},
};
static WB_KEYS(cycle_done, "report_cycle", "The calibration on whole cycles.");

static const struct wb_key cycle_failed_rows[] = {
    {"state", TEXT, "why there is no calibration", .choices = "missing|failed"},
    {"problem", TEXT, "why it is missing or failed"},
    {.of = &prediction_keys},
};
static WB_KEYS(cycle_failed, "report_cycle_missing",
               "A calibration on whole cycles that is not there.");

static const struct wb_keys *const cycles[] = {&cycle_done_keys, &cycle_failed_keys, NULL};
static const struct wb_keys cycle = {"cycle", "The calibration on whole cycles, or why not.",
                                     .alternatives = cycles};

static const struct wb_key wire_rows[] = {
    {"wire", WIRE(product.name), "name of the product"},
    {"label", WIRE(label), "name in the report"},
    {"conductor_diameter_mm", WIRE(product.conductor_diameter),
     "diameter of the conductor; 0: no single one"},
    {"outer_diameter_mm", WIRE(product.outer_diameter), "outer diameter"},
    {"density_g_cm3", WIRE(product.density), "mean density over the outer diameter"},
    {"published", OBJECT | OPTIONAL, "published properties", &published_keys},
    {"calibration", OBJECT, "calibration by the paper's route", &calibration_keys},
    {"validation", OBJECT, "validation of that calibration", &validation_keys},
    {"cycle", OBJECT | OPTIONAL, "calibration on whole cycles", &cycle},
};
static WB_KEYS(wire, "report_wire", "A wire of a campaign of recordings.");

static const struct wb_key wb_recordings_json_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"virtual_rig", WB_AT(struct wb_recordings_results, any_virtual),
     "a recording that is used comes from a virtual rig"},
    {"settings", OBJECT, "settings of the calibration", &settings_keys},
    {"limits", OBJECT, "limits of the campaign", &limits_keys},
    {"recordings", OBJECT | LIST, "recordings of the campaign", &recording_keys},
    {"wires", OBJECT | LIST, "wires of the campaign", &wire_keys},
};
WB_KEYS(wb_recordings_json, "report_of_recordings", "The report of a campaign of recordings.");

/* --- values --- */

static const char *state_text(enum wb_recordings_results_state state)
{
    static const char *const texts[] = {"not wanted", "missing", "failed", "done"};
    return texts[state];
}

static void put_settings(struct wb_json *root, const struct wb_recordings *campaign)
{
    const struct wb_calibrate_settings meant = wb_calibrate_settings_meant(&campaign->head.fit);
    struct wb_json *const of = wb_json_set_object(root, "settings");
    WB_PUT(of, &settings_keys, struct wb_calibrate_settings, &meant);
    struct wb_json *const largest = wb_json_set_object(root, "limits");
    if (campaign->limit[WB_RECORDINGS_CALIBRATION] > 0.0)
        wb_json_set_number(largest, "calibration_rms_max", campaign->limit[0]);
    if (campaign->limit[WB_RECORDINGS_VALIDATION] > 0.0)
        wb_json_set_number(largest, "validation_rms_max", campaign->limit[1]);
}

static void put_test(struct wb_json *list, const struct wb_recordings_results_wire *wire,
                     const struct wb_recordings_results_test *test,
                     enum wb_recordings_purpose purpose)
{
    struct wb_json *const entry = wb_json_append_object(list);
    WB_PUT(entry, &recording_keys, struct wb_recordings_test, test->wanted);
    wb_json_set_text(entry, "wire", wire->wanted->product.name);
    wb_json_set_text(entry, "purpose", wb_recordings_purposes[purpose]);
    WB_PUT(entry, &recording_keys, struct wb_recordings_results_test, test);
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
    WB_PUT(entry, &recording_keys, struct wb_recordings_results_test, test);
    wb_json_set_number(entry, "bow_mm", wb_dataset_bow(&test->dataset.info) / WB_MM);
    static const char *const parts[] = {"corrections", "checks", "warnings"};
    for (int k = 0; k < 3; k++) {
        const struct wb_json *const part = wb_json_get(test->dataset.document, parts[k]);
        if (part)
            wb_json_set_copy(entry, parts[k], part);
    }
}

static void put_comparison(struct wb_json *object, const struct wb_validate_result *result,
                           double scatter, double residual)
{
    const struct wb_curve *const curve = &result->curve;
    WB_PUT(object, &comparison_keys, struct wb_validate_result, result);
    wb_json_set_number(object, "scatter_rms_over_F_max",
                       curve->n_samples > 1 ? scatter : (double)NAN);
    wb_json_set_number(object, "residual_scatter_rms_over_F_max",
                       curve->n_samples > 1 ? residual : (double)NAN);
    WB_PUT(object, &comparison_keys, struct wb_validate_result, result);
    wb_json_set_number(object, "mean_bow_mm", wb_dataset_bow(&result->info) / WB_MM);
    struct wb_json *const mean = wb_json_set_object(object, "measured");
    struct wb_json *const deflection = wb_json_set_array(mean, "deflection_mm");
    for (int i = 0; i < curve->n; i++)
        wb_json_append_number(deflection, i * curve->step / WB_MM);
    WB_PUT(mean, &measured_keys, struct wb_curve, curve);
    WB_PUT(object, &comparison_keys, struct wb_validate_result, result);
}

static void put_validation(struct wb_json *object, const struct wb_validate_result *result)
{
    put_comparison(object, result, result->scatter_rms, result->residual_scatter_rms);
    WB_PUT(object, &expected_keys, struct wb_validate_result, result);
    wb_validate_json_put_cycles(object, result);
}

static void put_uncertainties(struct wb_json *object, const struct wb_calibrate_result *result)
{
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    struct wb_json *const entry = wb_json_set_object(object, "standard_uncertainties");
    WB_PUT(entry, &uncertainties_keys, struct wb_calibrate_result, result);
    wb_json_set_number(entry, "strength_coefficient_factor", exp(result->deviation[2]));
    WB_PUT(entry, &uncertainties_keys, struct wb_calibrate_result, result);
    WB_PUT(object, &calibration_keys, struct wb_calibrate_result, result);
    struct wb_json *const list = wb_json_set_array(object, "remarks");
    const int n = wb_calibrate_remarks(result, remarks);
    for (int i = 0; i < n; i++)
        wb_json_append_text(list, remarks[i]);
}

static void put_search(struct wb_json *object, const struct wb_calibrate_result *c)
{
    struct wb_json *const of = wb_json_set_object(object, "search");
    WB_PUT(of, &search_keys, struct wb_calibrate_result, c);
    wb_json_set_text(of, "stopped_because", wb_calibrate_end_text(c->end));
    WB_PUT(of, &search_keys, struct wb_calibrate_result, c);
    struct wb_json *const k = wb_json_set_array(of, "strength_coefficient_MPa");
    struct wb_json *const n = wb_json_set_array(of, "hardening_exponent");
    struct wb_json *const error = wb_json_set_array(of, "error_over_F_max");
    struct wb_json *const size = wb_json_set_array(of, "simplex_size");
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
    WB_PUT(object, &calibration_keys, struct wb_calibrate_result, c);
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
                       const struct wb_recordings_cycle *of_wire)
{
    struct wb_json *const interval =
        wb_json_set_object(of, "flexural_rigidity_N_mm2_pooled_over_wires");
    double low, high;
    wb_recordings_cycle_interval(&results->pool, of_wire, &low, &high);
    wb_json_set_number(interval, "low", low / WB_NMM2);
    wb_json_set_number(interval, "high", high / WB_NMM2);
    WB_PUT(interval, &pooled_keys, struct wb_recordings_cycle_pool, &results->pool);
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
    struct wb_json *const predicted = wb_json_set_object(of, "prediction");
    if (put_state(predicted, states[WB_RECORDINGS_VALIDATION], &wire->cycle_problems[1]))
        put_validation(predicted, &wire->prediction);
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
    WB_PUT(entry, &wire_keys, struct wb_recordings_wire, wanted);
    if (wanted->has_reference) {
        struct wb_json *const reference = wb_json_set_object(entry, "published");
        wb_numbers_put_properties(reference, &wanted->reference);
        WB_PUT(reference, &published_keys, struct wb_recordings_wire, wanted);
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
    WB_PUT(root, &wb_recordings_json_keys, struct wb_recordings_results, results);
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
