#include "tests/analysis/beam_data.h"

#include <unistd.h>

#include <gsl/gsl_cdf.h>

#include "analysis/validation/validate_bounds.h"
#include "base/file.h"

static const double mm = WB_MM;
static const struct wb_calibrate_settings settings = {.step = 1e-3, .n_elements = BEAM_ELEMENTS};

static struct wb_properties true_properties(int type)
{
    const struct wb_test_info info = beam_info(type, 0.085, 0.0);
    struct wb_properties properties = {
        .outer_diameter = info.outer_diameter,
        .mass_per_length = info.mass_per_length,
        .material = beam_material(type),
        .calibration_length = 0.085,
        .rms = (double)NAN,
        .residual_scatter_rms = (double)NAN,
        .scatter_rms = (double)NAN,
        .stiffness_deviation = (double)NAN,
        .largest_curvature = (double)NAN,
    };
    wb_law_init_ludwik(&properties.law, &properties.material);
    strcpy(properties.wire, info.wire);
    wb_law_init_ludwik(&properties.law, &properties.material);
    return properties;
}

static void validate(struct wb_validate_result *result, const struct wb_properties *properties,
                     double length, double bow, double factor,
                     const struct wb_calibrate_settings *how)
{
    const struct wb_test_info info = beam_info(2, length, bow);
    const struct wb_material material = beam_material(2);
    struct wb_dataset dataset;
    beam_dataset(&dataset, &info, &material, 1.0 * mm, 53 * mm, factor);
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(wb_validate_run(result, properties, datasets, 1, how, NULL), WB_OK);
    wb_dataset_release(&dataset);
}

static void true_properties_predict_another_length(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_validate_result result;
    validate(&result, &properties, 0.1, 0.0, 1.0, &settings);
    assert_int_equal(result.curve.n, 54);
    assert_int_equal(result.elastoplastic.n_reached, 54);
    assert_true(result.elastoplastic.rms < 1e-6);
    assert_true(result.elastoplastic.max_error < 1e-6);
    assert_true(result.shape_rms < 1e-3 * mm);
    assert_int_equal(result.n_shape_points, 54 * 6);
    /* Without plasticity the prediction is far too high, as in the paper's Fig. 14. */
    assert_true(result.elastic.rms > 0.1);
    assert_int_equal(result.elastic.n_reached, 54);
    assert_close(result.scatter_rms, 0.0, 0.0);
    assert_true(isnan(result.scatter_share));
    wb_validate_result_release(&result);
}

static void errors_are_over_the_largest_measured_force(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_validate_result result;
    validate(&result, &properties, 0.085, 0.0, 1.25, &settings);
    const struct wb_curve *const curve = &result.curve;
    /* Computed = measured / 1.25, so at the end the error is 1 - 1/1.25 of F_max. */
    assert_close_relative(result.elastoplastic.error[53], 0.2, 1e-6);
    assert_close_relative(result.elastoplastic.max_error, 0.2, 1e-6);
    double squares = 0.0;
    for (int i = 0; i < curve->n; i++)
        squares += (i == 0 || i == 53 ? 0.5 : 1.0) * pow(0.2 * curve->force[i], 2);
    const double rms = sqrt(squares / 53.0) / curve->max_force;
    assert_close_relative(result.elastoplastic.rms, rms, 1e-6);
    assert_true(result.elastoplastic.rms_from_5mm > result.elastoplastic.rms);
    wb_validate_result_release(&result);
}

static void ignoring_the_bow_increases_the_error(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_calibrate_settings straight = settings;
    struct wb_validate_result result;
    straight.straight = true;
    validate(&result, &properties, 0.085, 3.0 * mm, 1.0, &settings);
    assert_true(result.elastoplastic.rms < 1e-6);
    wb_validate_result_release(&result);
    validate(&result, &properties, 0.085, 3.0 * mm, 1.0, &straight);
    assert_true(result.elastoplastic.max_error > 0.02 && result.elastoplastic.max_error < 0.06);
    assert_true(result.shape_rms > 0.1 * mm);
    wb_validate_result_release(&result);
}

/* Their mean bow is zero, but their mean curve differs from that of a straight wire. */
static void each_sample_is_predicted_with_its_own_bow(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    const struct wb_material material = beam_material(2);
    struct wb_validate_result result;
    struct wb_dataset dataset[2];
    const struct wb_dataset *datasets[2];
    for (int i = 0; i < 2; i++) {
        const struct wb_test_info info = beam_info(2, 0.085, (i == 0 ? -5.0 : 5.0) * mm);
        beam_dataset(&dataset[i], &info, &material, 1.0 * mm, 53 * mm, 1.0);
        dataset[i].info.sample = i + 1;
        datasets[i] = &dataset[i];
    }
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 2, &settings, NULL), WB_OK);
    assert_true(result.scatter_rms > 0.01);
    assert_true(result.elastoplastic.rms < 1e-6);
    wb_validate_result_release(&result);
    for (int i = 0; i < 2; i++)
        wb_dataset_release(&dataset[i]);
}

/* Student's t of 0.975 for 2 and 5 degrees of freedom. */
static const double t2 = 4.302653, t5 = 2.570582;

static void expected_error_follows_from_the_scatter(void **state)
{
    (void)state;
    struct wb_properties properties = true_properties(2);
    const struct wb_test_info info = beam_info(2, 0.1, 0.0);
    const struct wb_material material = beam_material(2);
    const double factor[3] = {0.98, 1.03, 1.05};
    struct wb_dataset dataset[3];
    const struct wb_dataset *datasets[3];
    struct wb_validate_result result;
    for (int i = 0; i < 3; i++) {
        beam_dataset(&dataset[i], &info, &material, 1.0 * mm, 53 * mm, factor[i]);
        datasets[i] = &dataset[i];
    }
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 3, &settings, NULL), WB_OK);
    /* The mean is 2 % above the truth, the samples scatter by 3.6 %. Forces grow a little less than
     * the stiffness, because the weights do not change. */
    assert_close_relative(result.scatter_rms / result.elastoplastic.rms, 0.0361 / 0.02, 0.01);
    assert_int_equal(result.stiffness_degrees, 2);
    assert_close_relative(result.stiffness_deviation, 0.0358, 0.05);
    assert_close_relative(result.expected_rms, result.residual_scatter_rms / sqrt(3.0), 1e-9);
    assert_close_relative(result.expected_rms_95, t2 * result.expected_rms, 1e-6);
    assert_close_relative(result.scatter_share, 1.0, 1e-9);
    const double own = result.stiffness_deviation;
    const double G = result.expected_rms / own * sqrt(3.0);
    wb_validate_result_release(&result);
    /* The calibration's scatter is pooled with it, and the mean of the calibration is uncertain as
     * well. */
    properties.n_samples = 4;
    properties.stiffness_deviation = 0.07;
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 3, &settings, NULL), WB_OK);
    const double pooled = sqrt((2.0 * own * own + 3.0 * 0.07 * 0.07) / 5.0);
    assert_close_relative(result.stiffness_deviation, pooled, 1e-9);
    assert_close_relative(result.expected_rms, pooled * sqrt(1.0 / 3.0 + 1.0 / 4.0) * G, 1e-9);
    assert_close_relative(result.expected_rms_95, t5 * result.expected_rms, 1e-6);
    wb_validate_result_release(&result);
    /* Files without it have the scatter of curves; the smaller of the two is used. */
    properties.stiffness_deviation = (double)NAN;
    properties.scatter_rms = 0.01;
    properties.residual_scatter_rms = 0.06;
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 3, &settings, NULL), WB_OK);
    const double of_curves = sqrt((2.0 * own * own + 3.0 * pow(0.01 / G, 2)) / 5.0);
    assert_close_relative(result.stiffness_deviation, of_curves, 1e-9);
    wb_validate_result_release(&result);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

/* Two cycles of the beam model with a law. */
static void cycle_dataset(struct wb_dataset *dataset, const struct wb_law *law, double bow)
{
    const struct wb_test_info info = beam_info(2, 0.1, bow);
    struct wb_computed *computed;
    const struct wb_computed_settings how = {.law = law};
    const struct wb_row rest = {.stage = (double)NAN, .tip_x = (double)NAN};
    bool reached;
    double force = 0.0;
    wb_dataset_init(dataset);
    dataset->info = info;
    assert_int_equal(wb_computed_create(&computed, &info, &law->material, &how), WB_OK);
    assert_int_equal(wb_computed_start(computed, &law->material, &reached), WB_OK);
    for (int k = 0; k <= 4 * 50; k++) {
        struct wb_row row = rest;
        const int in_cycle = k % 100;
        row.t = k;
        row.cycle = k / 100 + 1 - (k == 200);
        row.phase = in_cycle > 50 || k == 100 || k == 200 ? WB_PHASE_UNLOAD : WB_PHASE_LOAD;
        row.deflection = (in_cycle <= 50 ? in_cycle : 100 - in_cycle) * mm;
        if (k == 100)
            row.cycle = 1;
        assert_int_equal(wb_computed_move(computed, row.deflection, &force, &reached), WB_OK);
        assert_true(reached);
        row.force = force;
        /* A weight of 20 mN on the strand, which becomes slack below it. */
        row.tension = force + 0.02;
        if (row.tension < 0.0)
            row.phase = WB_PHASE_SLACK;
        wb_dataset_add_row(dataset, &row);
    }
    wb_computed_destroy(computed);
}

static void unloading_and_later_cycles_follow_the_hardening_rule(void **state)
{
    (void)state;
    struct wb_properties kinematic = true_properties(2), plain = true_properties(2);
    struct wb_dataset dataset;
    const struct wb_dataset *const datasets[] = {&dataset};
    struct wb_validate_result result;
    kinematic.law.isotropic_share = 0.0;
    kinematic.largest_curvature = 100.0;
    kinematic.is_rule_tested = true;
    cycle_dataset(&dataset, &kinematic.law, 1.0 * mm);

    assert_int_equal(wb_validate_run(&result, &kinematic, datasets, 1, NULL, NULL), WB_OK);
    const struct wb_validate_cycles *const cycles = &result.cycles;
    assert_true(result.elastoplastic.rms < 1e-4);
    assert_int_equal(cycles->n_samples, 1);
    assert_true(cycles->n > 20);
    assert_true(cycles->rms < 0.01 && cycles->largest_error < 0.02);
    assert_close(cycles->residual_computed, cycles->residual_measured, 0.5 * mm);
    assert_true(cycles->residual_measured > 5.0 * mm);
    assert_int_equal(cycles->n_loops, 1);
    assert_close_relative(cycles->loops[0].computed, cycles->loops[0].measured, 0.02);
    assert_true(cycles->loops[0].measured > 1e-4);
    assert_false(result.is_rule_untested || result.is_beyond);
    const double left = cycles->residual_measured;
    wb_validate_result_release(&result);

    /* Another hardening rule has the same loading and another unloading; it is marked untested. */
    assert_int_equal(wb_validate_run(&result, &plain, datasets, 1, NULL, NULL), WB_OK);
    assert_true(result.elastoplastic.rms < 5e-3);
    assert_true(result.is_rule_untested);
    assert_true(cycles->rms > 0.05);
    assert_true(cycles->residual_computed > left + 3.0 * mm);
    assert_true(cycles->loops[0].computed < 0.5 * cycles->loops[0].measured);
    wb_validate_result_release(&result);

    kinematic.largest_curvature = 5.0;
    keep_messages();
    assert_int_equal(wb_validate_run(&result, &kinematic, datasets, 1, NULL, NULL), WB_OK);
    assert_true(result.is_beyond);
    assert_message("only up to 5 /m");
    wb_validate_result_release(&result);
    wb_dataset_release(&dataset);
}

/* Three samples that differ by 5 % in stiffness, and in their bows. With the law as stiff as each
 * sample, the remaining error of the unloading is that of the hardening rule. */
static void bounds_distinguish_a_wrong_rule_from_scatter(void **state)
{
    (void)state;
    static const double ln_stiffness[] = {-0.05, 0.01, 0.04}, bow[] = {1.0, -1.5, 0.5};
    struct wb_properties right = true_properties(2), wrong = right;
    struct wb_dataset dataset[3];
    const struct wb_dataset *datasets[3];
    struct wb_validate_result result;
    right.law.isotropic_share = 0.0;
    wrong.law.isotropic_share = 0.5;
    right.is_rule_tested = wrong.is_rule_tested = true;
    right.largest_curvature = wrong.largest_curvature = 100.0;
    for (int i = 0; i < 3; i++) {
        const struct wb_law law = wb_validate_stiffer(&right.law, ln_stiffness[i]);
        cycle_dataset(&dataset[i], &law, bow[i] * mm);
        dataset[i].info.sample = i + 1;
        datasets[i] = &dataset[i];
    }
    assert_int_equal(wb_validate_run(&result, &right, datasets, 3, NULL, NULL), WB_OK);
    const struct wb_validate_bound *const bounds = result.bounds;
    assert_false(wb_validate_bounds_exceeded(&result));
    assert_true(wb_validate_bounds_known(&result));
    assert_true(bounds[WB_VALIDATE_UNLOADING].found < 2e-3);
    assert_true(result.cycles.rms > 2.0 * bounds[WB_VALIDATE_UNLOADING].found);
    /* Three samples that agree: the smallest permitted deviation is used. */
    assert_close_relative(bounds[WB_VALIDATE_UNLOADING].bound,
                          gsl_cdf_tdist_Qinv(0.014, 2) * 2e-3 / sqrt(3.0), 0.05);
    assert_true(isnan(bounds[WB_VALIDATE_SHAPES].bound)); /* no markers */
    wb_validate_result_release(&result);

    assert_int_equal(wb_validate_run(&result, &wrong, datasets, 3, NULL, NULL), WB_OK);
    assert_false(bounds[WB_VALIDATE_LOADING].is_exceeded);
    assert_true(bounds[WB_VALIDATE_UNLOADING].is_exceeded);
    struct wb_text text = {0};
    wb_validate_bounds_append(&text, &result);
    assert_non_null(strstr(wb_text_string(&text), "unloading"));
    wb_text_release(&text);
    wb_validate_result_release(&result);

    /* One sample does not show how samples scatter. */
    assert_int_equal(wb_validate_run(&result, &wrong, datasets, 1, NULL, NULL), WB_OK);
    assert_true(isnan(bounds[WB_VALIDATE_UNLOADING].bound));
    assert_false(wb_validate_bounds_exceeded(&result));
    wb_validate_result_release(&result);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

static void without_unloading_data_the_unloading_is_not_scored(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_validate_result result;
    validate(&result, &properties, 0.085, 0.0, 1.0, &settings);
    assert_int_equal(result.cycles.n_samples, 0);
    assert_true(isnan(result.cycles.rms) && isnan(result.cycles.residual_measured));
    wb_validate_result_release(&result);
}

/* Identical straight samples, computed with bows that they do not have: all residual scatter comes
 * from the model, and explains no part of its error. */
static void an_error_of_the_bow_does_not_count_as_scatter(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_test_info info = beam_info(2, 0.1, 0.0);
    const struct wb_material material = beam_material(2);
    struct wb_dataset dataset[3];
    const struct wb_dataset *datasets[3];
    struct wb_validate_result result;
    for (int i = 0; i < 3; i++) {
        beam_dataset(&dataset[i], &info, &material, 1.0 * mm, 53 * mm, 1.0);
        dataset[i].info.n_natural_shape = 1;
        dataset[i].info.natural_shape[0] = 0.04 * (i + 1);
        datasets[i] = &dataset[i];
    }
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 3, &settings, NULL), WB_OK);
    assert_true(result.residual_scatter_rms > 0.01 && result.elastoplastic.rms > 0.01);
    assert_true(result.scatter_rms < 1e-6);
    assert_true(result.scatter_share < 1e-6);
    wb_validate_result_release(&result);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

static void another_wire_is_rejected_and_another_name_warned_about(void **state)
{
    (void)state;
    struct wb_properties properties = true_properties(0);
    const struct wb_test_info info = beam_info(2, 0.1, 0.0);
    const struct wb_material material = beam_material(2);
    struct wb_dataset dataset;
    struct wb_validate_result result;
    beam_dataset(&dataset, &info, &material, 1.0 * mm, 53 * mm, 1.0);
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &settings, NULL),
                     WB_ERR_DATA);
    assert_message("wire 'type1' (1.1 mm across)");
    struct wb_reason why = {.text = ""};
    keep_messages();
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &settings, &why),
                     WB_ERR_DATA);
    assert_non_null(strstr(why.text, "wire 'type1' (1.1 mm across)"));
    assert_string_equal(kept.last, "");
    properties = true_properties(2);
    strcpy(properties.wire, "type3 of another roll");
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &settings, NULL), WB_OK);
    assert_message("of the same diameter");
    wb_validate_result_release(&result);
    wb_dataset_release(&dataset);
}

static void a_prediction_that_does_not_converge_is_an_error(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_calibrate_settings coarse = settings;
    struct wb_dataset dataset;
    struct wb_validate_result result;
    double x[9], y[9];
    wb_dataset_init(&dataset);
    dataset.info = beam_info(2, 0.085, 0.0);
    /* A smaller step would converge: 80 m of deflection in one step. */
    coarse.step = 80.0;
    for (int k = 0; k < 20; k++) {
        const struct wb_row row = {.cycle = 1, .deflection = 80.0 * k, .force = 1e-3 * k};
        wb_dataset_add_row(&dataset, &row);
    }
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &coarse, NULL),
                     WB_ERR_CONVERGENCE);
    assert_message("does not converge");
    assert_int_equal(wb_validate_shape(&properties, &dataset.info, 1e9, 9, x, y),
                     WB_ERR_CONVERGENCE);
    wb_dataset_release(&dataset);
}

static void the_csv_has_a_row_for_each_deflection(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    struct wb_validate_result result;
    char path[] = "/tmp/wirebench-validate-XXXXXX";
    char *text;
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    validate(&result, &properties, 0.1, 0.0, 1.0, &settings);
    result.info.is_virtual = result.info.is_simulation = false;
    assert_int_equal(wb_validate_write_csv(&result, path), WB_OK);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    assert_memory_equal(text, "# wire ", 7);
    free(text);
    result.info.is_virtual = true;
    assert_int_equal(wb_validate_write_csv(&result, path), WB_OK);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    int lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, 2 + 54);
    assert_memory_equal(text, "# virtual rig, wire ", 20);
    assert_non_null(strstr(text, "\ndeflection_mm,measured_N,"));
    double deflection, measured;
    const char *const last = strstr(text, "\n53,");
    assert_non_null(last);
    assert_int_equal(sscanf(last, "\n%lf,%lf", &deflection, &measured), 2);
    assert_close(measured, result.curve.force[53], 0.0);
    free(text);
    unlink(path);
    wb_validate_result_release(&result);
}

static void a_shape_starts_at_the_clamp_and_ends_at_the_deflection(void **state)
{
    (void)state;
    const struct wb_properties properties = true_properties(2);
    const struct wb_test_info info = beam_info(2, 0.085, 2.0 * mm);
    double x[33], y[33], length = 0.0;
    assert_int_equal(wb_validate_shape(&properties, &info, 30 * mm, 33, x, y), WB_OK);
    assert_close(x[0], 0.0, 1e-9);
    assert_close(y[0], 0.0, 1e-9);
    assert_close(y[32], 30 * mm, 1e-6 * mm);
    for (int i = 1; i < 33; i++)
        length += hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
    assert_close_relative(length, 0.085, 1e-3);
    assert_int_equal(wb_validate_shape(&properties, &info, (double)NAN, 33, x, y), WB_ERR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(true_properties_predict_another_length),
        cmocka_unit_test(errors_are_over_the_largest_measured_force),
        cmocka_unit_test(ignoring_the_bow_increases_the_error),
        cmocka_unit_test(each_sample_is_predicted_with_its_own_bow),
        cmocka_unit_test(expected_error_follows_from_the_scatter),
        cmocka_unit_test(an_error_of_the_bow_does_not_count_as_scatter),
        cmocka_unit_test(unloading_and_later_cycles_follow_the_hardening_rule),
        cmocka_unit_test(bounds_distinguish_a_wrong_rule_from_scatter),
        cmocka_unit_test(without_unloading_data_the_unloading_is_not_scored),
        cmocka_unit_test(another_wire_is_rejected_and_another_name_warned_about),
        cmocka_unit_test(a_prediction_that_does_not_converge_is_an_error),
        cmocka_unit_test(the_csv_has_a_row_for_each_deflection),
        cmocka_unit_test(a_shape_starts_at_the_clamp_and_ends_at_the_deflection),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
