/* Searches and priors that fits share, on problems whose answers are known. */
#include "analysis/dataset/least_squares.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "tests/check.h"

enum {
    POINTS = 20
};

struct decay {
    int runs, fails_after; /* 0: never */
    enum wb_status status;
};

/* y = 3 exp(-2 t), from ln a and b. */
static int decay_residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    struct decay *const decay = context;
    if (decay->fails_after > 0 && ++decay->runs > decay->fails_after) {
        decay->status = WB_ERR_MEMORY;
        return GSL_EFAILED;
    }
    for (size_t i = 0; i < POINTS; i++) {
        const double t = 0.1 * (double)i;
        gsl_vector_set(f, i,
                       exp(gsl_vector_get(x, 0) - gsl_vector_get(x, 1) * t) - 3.0 * exp(-2.0 * t));
    }
    return GSL_SUCCESS;
}

static bool search(struct decay *decay, struct wb_least_squares_search *how, double x[2],
                   int *iterations)
{
    gsl_multifit_nlinear_fdf fdf = {.f = decay_residuals, .n = POINTS, .p = 2, .params = decay};
    double start[2] = {0.0, 0.0};
    const gsl_vector_view from = gsl_vector_view_array(start, 2);
    gsl_multifit_nlinear_workspace *const w = wb_least_squares_create(POINTS, 2);
    assert_non_null(w);
    assert_int_equal(gsl_multifit_nlinear_init(&from.vector, &fdf, w), GSL_SUCCESS);
    how->status = &decay->status;
    *iterations = 0;
    const bool arrived = wb_least_squares_iterate(w, how, iterations);
    x[0] = gsl_vector_get(w->x, 0);
    x[1] = gsl_vector_get(w->x, 1);
    gsl_multifit_nlinear_free(w);
    return arrived;
}

static void decay_is_found_again(void **unused)
{
    (void)unused;
    struct decay decay = {0};
    struct wb_least_squares_search how = {
        .max_iterations = 100, .smallest_step = 1e-8, .smallest_gain = 1e-12};
    double x[2];
    int iterations;
    assert_true(search(&decay, &how, x, &iterations));
    assert_close(x[0], log(3.0), 1e-6);
    assert_close(x[1], 2.0, 1e-6);
    assert_true(iterations > 2 && iterations < 100);
}

static void iterations_run_out(void **unused)
{
    (void)unused;
    struct decay decay = {0};
    struct wb_least_squares_search how = {
        .max_iterations = 2, .smallest_step = 1e-8, .smallest_gain = 1e-12};
    double x[2];
    int iterations;
    assert_false(search(&decay, &how, x, &iterations));
    assert_int_equal(iterations, 2);
}

static void small_gains_end_it_when_patience_does(void **unused)
{
    (void)unused;
    for (int patience = 0; patience < 3; patience++) {
        struct decay decay = {0};
        struct wb_least_squares_search how = {
            .max_iterations = 100, .smallest_step = 0.0, .smallest_gain = 1e9};
        double x[2];
        int iterations;
        how.patience = patience;
        assert_true(search(&decay, &how, x, &iterations));
        assert_int_equal(iterations, 1 + patience);
    }
}

static void a_failure_of_the_residuals_ends_the_search(void **unused)
{
    (void)unused;
    struct decay decay = {.fails_after = 8};
    struct wb_least_squares_search how = {
        .max_iterations = 100, .smallest_step = 1e-8, .smallest_gain = 1e-12};
    double x[2];
    int iterations;
    assert_false(search(&decay, &how, x, &iterations));
    assert_int_equal(decay.status, WB_ERR_MEMORY);
    assert_true(iterations < 100);
}

static void the_elastic_part_may_be_as_stiff_as_it_is(void **unused)
{
    (void)unused;
    struct wb_law_part parts[5];
    double r[8] = {0.0};
    for (int i = 0; i < 5; i++)
        parts[i] = (struct wb_law_part){pow(2.0, i), 1e-3 * (i + 1)};
    parts[4].modulus = 1e6; /* of a jacket */
    assert_int_equal(wb_least_squares_smooth_parts(parts, 5, 2.0, r), 2);
    for (int i = 0; i < 5; i++)
        assert_close(r[i], 0.0, 1e-12);
    parts[1].modulus *= exp(1.0);
    assert_int_equal(wb_least_squares_smooth_parts(parts, 5, 2.0, r), 2);
    assert_close(r[0], -1.0, 1e-12);
    assert_close(r[1], 0.5, 1e-12);
}

static void errors_of_the_library_do_not_end_the_program(void **unused)
{
    (void)unused;
    gsl_multifit_nlinear_workspace *const w = wb_least_squares_create(POINTS, 2);
    gsl_matrix *const nothing = gsl_matrix_calloc(2, 2);
    assert_int_not_equal(gsl_linalg_cholesky_decomp1(nothing), GSL_SUCCESS);
    gsl_matrix_free(nothing);
    gsl_multifit_nlinear_free(w);
}

static void moduli_stay_positive_and_grow_evenly(void **unused)
{
    (void)unused;
    assert_close(wb_least_squares_positive(0.0), 1.0, 1e-12);
    for (double x = -50.0; x < 60.0; x += 0.5) {
        const double y = wb_least_squares_positive(x), next = wb_least_squares_positive(x + 0.5);
        assert_true(y > 0.0 && next > y);
        if (x > 3.0)
            assert_close_relative(next - y, 0.5 * M_E / (M_E - 1.0), 0.01);
        if (x < -3.0)
            assert_close_relative(next / y, exp(0.5 * M_E / (M_E - 1.0)), 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_of_the_library_do_not_end_the_program),
        cmocka_unit_test(decay_is_found_again),
        cmocka_unit_test(small_gains_end_it_when_patience_does),
        cmocka_unit_test(iterations_run_out),
        cmocka_unit_test(a_failure_of_the_residuals_ends_the_search),
        cmocka_unit_test(moduli_stay_positive_and_grow_evenly),
        cmocka_unit_test(the_elastic_part_may_be_as_stiff_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
