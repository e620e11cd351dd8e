#include "analysis/dataset/fit.h"

#include <gsl/gsl_cdf.h>

#include "tests/check.h"

/* Tables of Fisher's F; of two degrees in the numerator the closed form, of one the square of
 * Student's t. */
static void limits_of_f_tests_are_those_of_tables(void **state)
{
    (void)state;
    assert_close(wb_fit_fisher_limit(0.01, 10.0, 10.0), 4.849, 5e-4);
    assert_close(wb_fit_fisher_limit(0.05, 3.0, 20.0), 3.098, 5e-4);
    assert_close(wb_fit_fisher_limit(0.01, 1.0, 5.0), 16.258, 5e-4);
    for (double degrees = 1.0; degrees < 1e4; degrees *= 1.7) {
        const double closed = 0.5 * degrees * (pow(0.01, -2.0 / degrees) - 1.0);
        assert_close_relative(wb_fit_fisher_limit(0.01, 2.0, degrees), closed, 1e-9);
        const double t = gsl_cdf_tdist_Qinv(0.025, degrees);
        assert_close_relative(wb_fit_fisher_limit(0.05, 1.0, degrees), t * t, 1e-9);
    }
}

static void every_pair_of_degrees_has_a_limit(void **state)
{
    (void)state;
    for (int a = 1; a < 3000; a += 1 + a / 5) {
        for (int b = 1; b < 3000; b += 1 + b / 7) {
            const double limit = wb_fit_fisher_limit(0.01, a, b);
            if (!(fabs(gsl_cdf_fdist_Q(limit, a, b) - 0.01) < 1e-9))
                fail_msg("%d and %d degrees: %g", a, b, limit);
        }
    }
    assert_true(isfinite(wb_fit_fisher_limit(0.01, 11.0, 1602.0)));
    assert_true(isfinite(wb_fit_fisher_limit(0.01, 1.0, 624.0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits_of_f_tests_are_those_of_tables),
        cmocka_unit_test(every_pair_of_degrees_has_a_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
