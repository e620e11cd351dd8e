#include "tests/analysis/beam_data.h"

#include "analysis/calibration/paper/calibrate_private.h"

#define WB_LOG_DOMAIN "test"

static const double mm = WB_MM;

enum {
    MOST = 3
};

/* Deviations of samples whose K differ by these factors, E and sigma_Y being given. */
static int run(double deviation[4], int n, const double strength[MOST], double last)
{
    const struct wb_test_info info = beam_info(2, 0.085, 0.0);
    const struct wb_material truth = beam_material(2);
    struct wb_calibrate_settings settings = beam_settings();
    struct wb_dataset dataset[MOST];
    const struct wb_dataset *datasets[MOST];
    struct wb_calibrate_result result = {.material = truth};
    settings.youngs_modulus = truth.youngs_modulus;
    settings.yield_stress = truth.yield_stress;
    for (int i = 0; i < n; i++) {
        struct wb_material material = truth;
        material.strength_coefficient *= strength[i];
        beam_dataset(&dataset[i], &info, &material, 1.0 * mm, last, 1.0);
        datasets[i] = &dataset[i];
    }
    assert_int_equal(wb_calibrate_deviations(&result, datasets, n, &settings, NULL), WB_OK);
    memcpy(deviation, result.deviation, sizeof result.deviation);
    for (int i = 0; i < n; i++)
        wb_dataset_release(&dataset[i]);
    return result.evaluations;
}

static void scatter_of_k_alone_is_found_in_k(void **state)
{
    (void)state;
    const double strength[MOST] = {0.98, 1.0, 1.02};
    double deviation[4];
    const int evaluations = run(deviation, 3, strength, 53 * mm);
    /* Standard error of three values 2 % apart: 0.02/sqrt(3); the forces are nearly linear in K. */
    assert_close_relative(deviation[2], 0.02 / sqrt(3.0), 0.03);
    assert_true(deviation[3] < 1e-3);
    assert_close(deviation[0], 0.0, 1e-3);
    assert_true(evaluations >= 9 && evaluations < 60);
}

static void equal_samples_have_no_deviation(void **state)
{
    (void)state;
    const double strength[MOST] = {1.0, 1.0, 1.0};
    double deviation[4];
    run(deviation, 2, strength, 53 * mm);
    for (int k = 0; k < 3; k++)
        assert_true(deviation[k] / (k < 2 ? beam_material(2).youngs_modulus : 1.0) < 1e-6);
    assert_true(deviation[3] < 1e-6);
}

static void one_sample_gives_no_deviation(void **state)
{
    (void)state;
    const double strength[MOST] = {1.0, 1.0, 1.0};
    double deviation[4];
    assert_int_equal(run(deviation, 1, strength, 53 * mm), 0);
    for (int k = 0; k < 4; k++)
        assert_true(isnan(deviation[k]));
}

static int n_errors, n_warnings;

static void count(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)domain;
    (void)message;
    n_errors += level == WB_LOG_ERROR;
    n_warnings += level == WB_LOG_WARNING;
}

static void an_unusable_subset_is_a_warning_and_not_an_error(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(2, 0.085, 0.0);
    const struct wb_material truth = beam_material(2);
    const struct wb_calibrate_settings settings = beam_settings();
    struct wb_dataset dataset[2];
    const struct wb_dataset *const datasets[] = {&dataset[0], &dataset[1]};
    struct wb_calibrate_result result = {.material = truth};
    for (int i = 0; i < 2; i++)
        beam_dataset(&dataset[i], &info, &truth, 1.0 * mm, 53 * mm, 1.0);
    /* Alone, the second sample has a reversed force. */
    for (size_t i = 0; i < dataset[1].n_rows; i++)
        dataset[1].rows[i].force *= -0.2;
    wb_log_set_sink(count, NULL);
    assert_int_equal(wb_calibrate_deviations(&result, datasets, 2, &settings, NULL), WB_OK);
    assert_int_equal(n_errors, 0);
    assert_int_equal(n_warnings, 2);
    for (int k = 0; k < 4; k++)
        assert_true(isnan(result.deviation[k]));
    /* Afterwards errors are counted as errors again. */
    wb_error("a test");
    assert_int_equal(n_errors, 1);
    keep_messages();
    for (int i = 0; i < 2; i++)
        wb_dataset_release(&dataset[i]);
}

static void the_deviation_of_k_is_a_factor(void **state)
{
    (void)state;
    /* Half and twice the mean: the deviation in K itself would be as large as K. */
    const double strength[MOST] = {0.3, 1.0, 3.0};
    double deviation[4];
    run(deviation, 3, strength, 53 * mm);
    print_message("           K within a factor of %.3g\n", exp(deviation[2]));
    assert_true(deviation[2] > 0.2 && deviation[2] < 2.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scatter_of_k_alone_is_found_in_k),
        cmocka_unit_test(equal_samples_have_no_deviation),
        cmocka_unit_test(one_sample_gives_no_deviation),
        cmocka_unit_test(an_unusable_subset_is_a_warning_and_not_an_error),
        cmocka_unit_test(the_deviation_of_k_is_a_factor),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
