#include "tests/analysis/beam_data.h"

#include <unistd.h>

#include "analysis/validate.h"
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
    };
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
    /* Without plasticity the prediction is far off, as in the paper's Fig. 14. */
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

static void a_bow_that_is_ignored_shows(void **state)
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

static void scatter_explains_what_the_average_of_few_cannot(void **state)
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
    /* The mean is 2 % above the truth, the samples scatter by 3.6 %. */
    assert_close_relative(result.scatter_rms / result.elastoplastic.rms, 0.0361 / 0.02, 0.01);
    assert_close_relative(result.expected_rms, result.residual_scatter_rms / sqrt(3.0), 1e-9);
    assert_close_relative(result.scatter_share, 1.0, 1e-9);
    wb_validate_result_release(&result);
    /* The calibration's own scatter adds to it. */
    properties.n_samples = 4;
    properties.scatter_rms = 0.07;
    properties.residual_scatter_rms = 0.06;
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 3, &settings, NULL), WB_OK);
    assert_close_relative(result.expected_rms, hypot(result.residual_scatter_rms / sqrt(3.0), 0.03),
                          1e-9);
    wb_validate_result_release(&result);
    /* Less scatter than residual scatter: the model makes the rest. */
    properties.scatter_rms = 0.01;
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 3, &settings, NULL), WB_OK);
    assert_close_relative(result.expected_rms,
                          hypot(result.residual_scatter_rms / sqrt(3.0), 0.005), 1e-9);
    wb_validate_result_release(&result);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

/* Straight samples all alike, computed with bows that they do not have: all residual scatter is the
 * model's, and none of its error is explained. */
static void an_error_with_the_bow_is_not_taken_for_scatter(void **state)
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

static void another_wire_is_refused_and_another_name_warned_about(void **state)
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
    assert_int_equal(wb_dataset_init(&dataset), WB_OK);
    dataset.info = beam_info(2, 0.085, 0.0);
    /* Nothing less upsets the beam: 80 m of deflection in one step. */
    coarse.step = 80.0;
    for (int k = 0; k < 20; k++) {
        const struct wb_row row = {.cycle = 1, .deflection = 80.0 * k, .force = 1e-3 * k};
        assert_int_equal(wb_dataset_add_row(&dataset, &row), WB_OK);
    }
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &coarse, NULL),
                     WB_ERR_CONVERGENCE);
    assert_message("does not converge");
    assert_int_equal(wb_validate_shape(&properties, &dataset.info, 1e9, 9, x, y),
                     WB_ERR_CONVERGENCE);
    wb_dataset_release(&dataset);
}

static void the_csv_has_a_line_for_each_deflection(void **state)
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
        cmocka_unit_test(a_bow_that_is_ignored_shows),
        cmocka_unit_test(scatter_explains_what_the_average_of_few_cannot),
        cmocka_unit_test(an_error_with_the_bow_is_not_taken_for_scatter),
        cmocka_unit_test(another_wire_is_refused_and_another_name_warned_about),
        cmocka_unit_test(a_prediction_that_does_not_converge_is_an_error),
        cmocka_unit_test(the_csv_has_a_line_for_each_deflection),
        cmocka_unit_test(a_shape_starts_at_the_clamp_and_ends_at_the_deflection),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
