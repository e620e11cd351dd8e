#include "analysis/predict/hypercube.h"

#include <stdbool.h>

#include "tests/check.h"

enum {
    N = 200,
    D = 12
};

static double points[N * D], others[N * D];

static void each_stratum_of_each_dimension_has_one_point(void **state)
{
    (void)state;
    wb_hypercube_fill(7, N, D, points);
    for (int d = 0; d < D; d++) {
        bool is_taken[N] = {false};
        for (int i = 0; i < N; i++) {
            const double u = points[i * D + d];
            assert_true(u > 0.0 && u < 1.0);
            const int stratum = (int)(u * N);
            assert_false(is_taken[stratum]);
            is_taken[stratum] = true;
        }
    }
}

/* Points are not all at the middle of their stratum: their mean square about it is 1/12 of its
 * width squared. */
static void points_lie_anywhere_in_their_stratum(void **state)
{
    (void)state;
    double square = 0.0;
    wb_hypercube_fill(7, N, D, points);
    for (int i = 0; i < N * D; i++) {
        const double off = points[i] * N - floor(points[i] * N) - 0.5;
        square += off * off / (N * D);
    }
    assert_close_relative(square, 1.0 / 12.0, 0.05);
}

/* In random order the largest of these 66 correlations would be about 0.18. */
static void dimensions_are_not_correlated(void **state)
{
    (void)state;
    double largest = 0.0;
    wb_hypercube_fill(3, N, D, points);
    for (int a = 0; a < D; a++)
        for (int b = 0; b < a; b++) {
            double sum = 0.0;
            for (int i = 0; i < N; i++)
                sum += (points[i * D + a] - 0.5) * (points[i * D + b] - 0.5);
            largest = fmax(largest, fabs(12.0 * sum / N));
        }
    print_message("largest correlation %.4f\n", largest);
    assert_true(largest < 0.05);
}

static void the_same_seed_gives_the_same_points_and_another_one_others(void **state)
{
    (void)state;
    wb_hypercube_fill(3, N, D, points);
    wb_hypercube_fill(3, N, D, others);
    assert_memory_equal(points, others, sizeof points);
    wb_hypercube_fill(4, N, D, others);
    int same = 0;
    for (int i = 0; i < N * D; i++)
        same += (int)(points[i] * N) == (int)(others[i] * N);
    assert_true(same < 40); /* 12 are expected */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_stratum_of_each_dimension_has_one_point),
        cmocka_unit_test(points_lie_anywhere_in_their_stratum),
        cmocka_unit_test(dimensions_are_not_correlated),
        cmocka_unit_test(the_same_seed_gives_the_same_points_and_another_one_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
