#include "tests/analysis/beam_data.h"

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/paper/first_guess.h"

static const double mm = WB_MM;

static void k_and_n_are_recovered_when_e_and_sigma_y_are_given(void **state)
{
    (void)state;
    for (int type = 0; type < 3; type++) {
        const struct wb_test_info info = beam_info(type, 0.085, 0.0);
        const struct wb_material truth = beam_material(type);
        struct wb_calibrate_settings settings = beam_settings();
        struct wb_calibrate_result result;
        struct wb_dataset dataset;
        beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, 1.0);
        settings.youngs_modulus = truth.youngs_modulus;
        settings.yield_stress = truth.yield_stress;
        assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
        assert_close_relative(result.material.strength_coefficient, truth.strength_coefficient,
                              0.01);
        assert_close_relative(result.material.hardening_exponent, truth.hardening_exponent, 0.01);
        assert_true(result.rms < 1e-3);
        assert_true(result.max_error < 2e-3);
        assert_true(result.end == WB_CALIBRATE_ERROR || result.end == WB_CALIBRATE_SIZE);
        wb_calibrate_result_release(&result);
        wb_dataset_release(&dataset);
    }
}

/* Eqs. 10 and 11 assume small deflection, no weight and a vertical force; their error here, with
 * strand, weight and counterweight, is below 1 %. */
static void e_and_sigma_y_of_the_closed_forms_are_near_the_truth(void **state)
{
    (void)state;
    for (int type = 0; type < 3; type++) {
        const struct wb_test_info info = beam_info(type, 0.085, 0.0);
        const struct wb_material truth = beam_material(type);
        struct wb_first_guess guess;
        struct wb_dataset dataset;
        struct wb_curve curve;
        beam_dataset(&dataset, &info, &truth, 0.5 * mm, 12 * mm, 1.0);
        const struct wb_dataset *const datasets[] = {&dataset};
        assert_int_equal(curve_average(&curve, datasets, 1, 0.5 * mm), WB_OK);
        assert_int_equal(wb_first_guess_run(&guess, &curve, &info, 0.05, 0.04, NULL), WB_OK);
        assert_close_relative(guess.youngs_modulus, truth.youngs_modulus, 0.007);
        assert_close_relative(guess.yield_stress, truth.yield_stress, 0.011);
        wb_curve_release(&curve);
        wb_dataset_release(&dataset);
    }
}

static void the_method_fits_its_own_model(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(2, 0.085, 0.0);
    const struct wb_material truth = beam_material(2);
    const struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, 1.0);
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_true(result.rms < 1e-3);
    assert_close_relative(result.material.strength_coefficient, truth.strength_coefficient, 0.1);
    assert_close_relative(result.material.hardening_exponent, truth.hardening_exponent, 0.03);
    /* E and sigma_Y remain the values of eqs. 10 and 11. */
    assert_close_relative(result.material.youngs_modulus, truth.youngs_modulus, 0.01);
    assert_close_relative(result.max_force, dataset.rows[dataset.n_rows - 1].force, 1e-9);
    assert_int_equal(result.failed_evaluations, 0);
    for (int k = 0; k < 4; k++)
        assert_true(isnan(result.deviation[k]));

    /* The path begins at (K0, n0), its error never increases, and the index of the restart is
     * given. */
    assert_true(result.n_path > 10);
    assert_close_relative(result.path[0].strength_coefficient, result.first_strength_coefficient,
                          1e-12);
    assert_close_relative(result.path[0].hardening_exponent, result.first_hardening_exponent,
                          1e-12);
    for (int i = 1; i < result.start_of_restart; i++)
        assert_true(result.path[i].error <= result.path[i - 1].error);
    assert_true(result.restarted == (result.start_of_restart < result.n_path));
    if (result.restarted)
        assert_true(result.restart_moved < 0.05);
    wb_calibrate_result_release(&result);
    wb_dataset_release(&dataset);
}

static void the_natural_shape_is_part_of_the_model(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(0, 0.085, 3.0 * mm);
    const struct wb_material truth = beam_material(0);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result bowed, straight;
    struct wb_dataset dataset;
    beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, 1.0);
    settings.restart = false;
    settings.youngs_modulus = truth.youngs_modulus;
    settings.yield_stress = truth.yield_stress;
    assert_int_equal(calibrate_one(&bowed, &dataset, &settings), WB_OK);
    settings.straight = true;
    assert_int_equal(calibrate_one(&straight, &dataset, &settings), WB_OK);
    assert_true(bowed.rms < 1e-3);
    assert_close_relative(bowed.material.strength_coefficient, truth.strength_coefficient, 0.01);
    assert_true(straight.rms > 10.0 * bowed.rms);
    wb_calibrate_result_release(&bowed);
    wb_calibrate_result_release(&straight);
    wb_dataset_release(&dataset);
}

static bool stop_at_ten(void *context, int evaluation, double error, double size)
{
    int *const calls = context;
    assert_true(error > 0.0 && size > 0.0);
    ++*calls;
    return evaluation < 10;
}

static void the_reason_of_the_end_is_given(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(1, 0.085, 0.0);
    const struct wb_material truth = beam_material(1);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    int calls = 0;
    beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, 1.0);

    settings.error_tolerance = 0.05;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_int_equal(result.end, WB_CALIBRATE_ERROR);
    assert_true(result.path[result.n_path - 1].error < 0.05);
    wb_calibrate_result_release(&result);

    settings.error_tolerance = 0.0;
    settings.size_tolerance = 0.02;
    settings.restart = false;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_int_equal(result.end, WB_CALIBRATE_SIZE);
    assert_false(result.restarted);
    assert_int_equal(result.start_of_restart, result.n_path);
    wb_calibrate_result_release(&result);

    settings.size_tolerance = 1e-9;
    settings.max_iterations = 3;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_int_equal(result.end, WB_CALIBRATE_ITERATIONS);
    wb_calibrate_result_release(&result);

    settings.max_iterations = 200;
    settings.progress = stop_at_ten;
    settings.progress_context = &calls;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_int_equal(result.end, WB_CALIBRATE_STOPPED);
    assert_true(calls > 1 && calls < 12);
    wb_calibrate_result_release(&result);
    wb_dataset_release(&dataset);
}

static void a_wire_that_did_not_yield_is_rejected(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(0, 0.085, 0.0);
    struct wb_material elastic = beam_material(0);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    beam_dataset(&dataset, &info, &elastic, 1.0 * mm, 53 * mm, 1.0);
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_DATA);
    assert_message("linear elastic prediction");
    wb_dataset_release(&dataset);

    /* The loading ends just beyond the yield point. */
    const struct wb_material truth = beam_material(0);
    settings.step = 0.5 * mm;
    beam_dataset(&dataset, &info, &truth, 0.5 * mm, 5.5 * mm, 1.0);
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_DATA);
    assert_message("yield is not reached: the first loading ends at 5.50 mm");
    wb_dataset_release(&dataset);
}

/* Each failure returns its reason to the caller and logs nothing. */
static void the_reason_of_a_failure_is_returned(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(0, 0.085, 0.0);
    const struct wb_material truth = beam_material(0);
    struct wb_material elastic = truth;
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    const struct wb_dataset *const datasets[] = {&dataset};
    struct wb_reason why = {.text = ""};
    keep_messages();
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    beam_dataset(&dataset, &info, &elastic, 1.0 * mm, 53 * mm, 1.0);
    assert_int_equal(wb_calibrate_run(&result, datasets, 1, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "linear elastic prediction"));
    wb_dataset_release(&dataset);
    beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, -1.0);
    assert_int_equal(wb_calibrate_run(&result, datasets, 1, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "sign"));
    dataset.rows[3].force = (double)NAN;
    assert_int_equal(wb_calibrate_run(&result, datasets, 1, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "no finite"));
    settings.elastic_zone = 0.9;
    assert_int_equal(wb_calibrate_run(&result, datasets, 1, &settings, &why), WB_ERR_ARGUMENT);
    assert_non_null(strstr(why.text, "out of range"));
    wb_dataset_release(&dataset);
    assert_string_equal(kept.last, "");
}

static void unusable_data_and_settings_are_rejected(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(0, 0.085, 0.0);
    const struct wb_material truth = beam_material(0);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, -1.0);
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_DATA);
    assert_message("sign");
    dataset.rows[3].force = (double)NAN;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_DATA);
    assert_message("no finite");
    settings.elastic_zone = 0.0;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_ARGUMENT);
    settings = beam_settings();
    settings.max_iterations = 0;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_ARGUMENT);
    wb_dataset_release(&dataset);
}

/* Multiplying all forces of a sample by a factor multiplies E and sigma_Y by it, and the jackknife
 * must give the standard error of the mean; K follows, n hardly changes. */
static void deviations_are_the_standard_errors_of_the_samples(void **state)
{
    (void)state;
    const double factor[3] = {0.97, 1.01, 1.02};
    const struct wb_test_info info = beam_info(1, 0.085, 0.0);
    const struct wb_material truth = beam_material(1);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset[3];
    const struct wb_dataset *datasets[3];
    double mean = 0.0, squares = 0.0;
    for (int i = 0; i < 3; i++) {
        beam_dataset(&dataset[i], &info, &truth, 1.0 * mm, 53 * mm, factor[i]);
        datasets[i] = &dataset[i];
        mean += factor[i] / 3.0;
    }
    for (int i = 0; i < 3; i++)
        squares += pow(factor[i] - mean, 2);
    const double standard_error = sqrt(squares / 2.0 / 3.0) / mean;
    settings.restart = false;
    assert_int_equal(wb_calibrate_run(&result, datasets, 3, &settings, NULL), WB_OK);
    assert_int_equal(result.n_samples, 3);
    assert_close_relative(result.deviation[0] / result.material.youngs_modulus, standard_error,
                          1e-3);
    assert_close_relative(result.deviation[1] / result.material.yield_stress, standard_error, 1e-3);
    assert_close_relative(result.deviation[2], standard_error, 0.3);
    assert_true(result.deviation[3] < 0.01);
    /* The scatter grows with the force. */
    assert_true(result.scatter_rms > 0.4 * sqrt(3.0) * standard_error);
    assert_close_relative(result.residual_scatter_rms, result.scatter_rms, 1e-6);
    wb_calibrate_result_release(&result);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

static void the_same_data_give_the_same_bits(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(2, 0.085, 1.0 * mm);
    const struct wb_material truth = beam_material(2);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result a, b;
    struct wb_dataset dataset;
    beam_dataset(&dataset, &info, &truth, 1.0 * mm, 53 * mm, 1.0);
    settings.size_tolerance = 0.01;
    settings.restart = false;
    assert_int_equal(calibrate_one(&a, &dataset, &settings), WB_OK);
    assert_int_equal(calibrate_one(&b, &dataset, &settings), WB_OK);
    assert_memory_equal(&a.material, &b.material, sizeof a.material);
    assert_int_equal(a.n_path, b.n_path);
    assert_memory_equal(a.path, b.path, (size_t)a.n_path * sizeof *a.path);
    wb_calibrate_result_release(&a);
    wb_calibrate_result_release(&b);
    wb_dataset_release(&dataset);
}

static void the_bias_of_the_bows_can_be_removed_from_e_and_the_yield_stress(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(1, 0.085, -3.0 * mm);
    const struct wb_material truth = beam_material(1);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_calibrate_result printed, corrected;
    struct wb_dataset dataset[2];
    const struct wb_dataset *const datasets[] = {&dataset[0], &dataset[1]};
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    for (int i = 0; i < 2; i++)
        beam_dataset(&dataset[i], &info, &truth, 1.0 * mm, 53 * mm, 1.0);
    assert_int_equal(wb_calibrate_run(&printed, datasets, 2, &settings, NULL), WB_OK);
    settings.bow_corrected = true;
    assert_int_equal(wb_calibrate_run(&corrected, datasets, 2, &settings, NULL), WB_OK);
    print_message("           bow -3 mm: E off by %+.1f %%, sigma_Y by %+.1f %% as printed; %+.1f "
                  "and %+.1f %% corrected; RMS %.5f and %.5f\n",
                  100.0 * (printed.material.youngs_modulus / truth.youngs_modulus - 1.0),
                  100.0 * (printed.material.yield_stress / truth.yield_stress - 1.0),
                  100.0 * (corrected.material.youngs_modulus / truth.youngs_modulus - 1.0),
                  100.0 * (corrected.material.yield_stress / truth.yield_stress - 1.0), printed.rms,
                  corrected.rms);
    assert_true(printed.material.youngs_modulus < 0.9 * truth.youngs_modulus);
    assert_false(printed.bow_corrected);
    assert_int_equal(wb_calibrate_remarks(&printed, remarks), 1);
    assert_non_null(strstr(remarks[0], "eqs. 10 and 11"));
    assert_true(corrected.bow_corrected);
    assert_int_equal(wb_calibrate_remarks(&corrected, remarks), 0);
    assert_close_relative(corrected.material.youngs_modulus, truth.youngs_modulus, 0.05);
    assert_close_relative(corrected.material.yield_stress, truth.yield_stress, 0.05);
    assert_true(corrected.rms < 0.5 * printed.rms);
    wb_calibrate_result_release(&printed);
    wb_calibrate_result_release(&corrected);
    for (int i = 0; i < 2; i++)
        wb_dataset_release(&dataset[i]);
}

static void limitations_of_the_result_are_remarked(void **state)
{
    (void)state;
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    struct wb_calibrate_result result = {
        .material = {.strength_coefficient = 5e8, .hardening_exponent = 0.8},
        .info = {.length = 0.085},
        .first_strength_coefficient = 4e8,
    };
    assert_int_equal(wb_calibrate_remarks(&result, remarks), 0);
    result.bow_spread = 2.0 * mm;
    assert_int_equal(wb_calibrate_remarks(&result, remarks), 1);
    result.material.hardening_exponent = 1.2;
    assert_int_equal(wb_calibrate_remarks(&result, remarks), 2);
    assert_non_null(strstr(remarks[1], "n is above 1"));
    result.material.hardening_exponent = 1.4999;
    assert_int_equal(wb_calibrate_remarks(&result, remarks), 3);
    assert_non_null(strstr(remarks[2], "bound"));
    result.material.hardening_exponent = 0.8;
    result.first_strength_coefficient = 5e14;
    assert_int_equal(wb_calibrate_remarks(&result, remarks), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(k_and_n_are_recovered_when_e_and_sigma_y_are_given),
        cmocka_unit_test(e_and_sigma_y_of_the_closed_forms_are_near_the_truth),
        cmocka_unit_test(the_method_fits_its_own_model),
        cmocka_unit_test(the_natural_shape_is_part_of_the_model),
        cmocka_unit_test(the_reason_of_the_end_is_given),
        cmocka_unit_test(a_wire_that_did_not_yield_is_rejected),
        cmocka_unit_test(the_reason_of_a_failure_is_returned),
        cmocka_unit_test(unusable_data_and_settings_are_rejected),
        cmocka_unit_test(deviations_are_the_standard_errors_of_the_samples),
        cmocka_unit_test(the_same_data_give_the_same_bits),
        cmocka_unit_test(the_bias_of_the_bows_can_be_removed_from_e_and_the_yield_stress),
        cmocka_unit_test(limitations_of_the_result_are_remarked),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
