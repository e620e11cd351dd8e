#include "tests/check.h"

#include "analysis/dataset/errors.h"

enum {
    N = 101
};

/* Difference x/X with F_max 2 on 0..X: E_L2 = sqrt(X/3), RMS = 1/(2 sqrt(3)), largest 1/2. */
static const double range = 0.05;

static void fill(double *measured, double *computed)
{
    for (int i = 0; i < N; i++) {
        const double x = (double)i / (N - 1);
        measured[i] = 2.0 * x;
        computed[i] = 2.0 * x - x;
    }
}

static void l2_norm_is_that_of_equation_17(void **state)
{
    (void)state;
    double measured[N], computed[N];
    fill(measured, computed);
    assert_close_relative(wb_errors_l2(N, range / (N - 1), measured, computed), sqrt(range / 3.0),
                          1e-4);
}

static void rms_is_that_of_equation_19(void **state)
{
    (void)state;
    double measured[N], computed[N], error[N];
    fill(measured, computed);
    wb_errors_curve(N, measured, computed, 2.0, error);
    assert_close(error[N - 1], 0.5, 1e-15);
    assert_close_relative(wb_errors_rms(N, error), 0.5 / sqrt(3.0), 1e-4);
    assert_close(wb_errors_largest(N, error), 0.5, 1e-15);
}

static void relative_l2_norm_equals_the_rms(void **state)
{
    (void)state;
    double measured[N], computed[N], error[N];
    fill(measured, computed);
    wb_errors_curve(N, measured, computed, 2.0, error);
    assert_close_relative(wb_errors_relative_l2(N, range / (N - 1), measured, computed, 2.0),
                          wb_errors_rms(N, error), 1e-12);
}

static void error_of_equation_18_has_no_sign(void **state)
{
    (void)state;
    const double measured[2] = {1.0, 1.0}, computed[2] = {0.9, 1.2};
    double error[2];
    wb_errors_curve(2, measured, computed, 4.0, error);
    assert_close(error[0], 0.025, 1e-15);
    assert_close(error[1], 0.05, 1e-15);
}

static void not_a_number_is_not_hidden(void **state)
{
    (void)state;
    double measured[N], computed[N], error[N];
    fill(measured, computed);
    computed[40] = (double)NAN;
    wb_errors_curve(N, measured, computed, 2.0, error);
    assert_true(isnan(wb_errors_rms(N, error)));
    assert_true(isnan(wb_errors_largest(N, error)));
    assert_true(isnan(wb_errors_l2(N, 1.0, measured, computed)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(l2_norm_is_that_of_equation_17),
        cmocka_unit_test(rms_is_that_of_equation_19),
        cmocka_unit_test(relative_l2_norm_equals_the_rms),
        cmocka_unit_test(error_of_equation_18_has_no_sign),
        cmocka_unit_test(not_a_number_is_not_hidden),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
