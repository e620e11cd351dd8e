#include "fe/linear/band.h"

#include <lapacke.h>
#include <stdlib.h>

#include "tests/check.h"
#include "tests/fe/rod/wires.h"

enum {
    N = 90,
    WIDTH = 8,
    ROW = 3 * WIDTH + 1
};

/* Equations with the different magnitudes of forces and moments. */
static double size_of_row(int i)
{
    return i % 3 == 2 ? 1e-5 : 1.0;
}

static void solution_agrees_with_lapack(void **unused)
{
    (void)unused;
    static double values[N * ROW], dense[N * N];
    uint64_t random = 20261122;

    for (int trial = 0; trial < 30; trial++) {
        struct wb_band band = {.n = N, .width = WIDTH, .values = values};
        double b[N], x[N];
        lapack_int pivots[N];
        wb_band_clear(&band);
        memset(dense, 0, sizeof dense);
        for (int i = 0; i < N; i++) {
            b[i] = size_of_row(i) * (test_random(&random) - 0.5);
            x[i] = b[i] / size_of_row(i);
            for (int j = i - WIDTH; j <= i + WIDTH; j++) {
                if (j < 0 || j >= N)
                    continue;
                /* Not diagonally dominant: pivoting is necessary. */
                const double value = test_random(&random) - 0.5;
                wb_band_add(&band, i, j, size_of_row(i) * value);
                dense[i * N + j] = value;
            }
        }
        assert_int_equal(LAPACKE_dgesv(LAPACK_ROW_MAJOR, N, 1, dense, N, pivots, x, 1), 0);
        assert_true(wb_band_solve(&band, b));
        for (int i = 0; i < N; i++)
            assert_close(b[i], x[i], 1e-8 * (1.0 + fabs(x[i])));
    }
}

static void held_unknown_has_its_value_and_leaves_the_rest(void **unused)
{
    (void)unused;
    double values[3 * 4], b[3] = {4.0 + 3.5, 100.0, 9.0 + 3.5};
    struct wb_band band = {.n = 3, .width = 1, .values = values};
    wb_band_clear(&band);
    wb_band_add(&band, 0, 0, 2.0);
    wb_band_add(&band, 0, 1, 7.0);
    wb_band_add(&band, 1, 0, 7.0);
    wb_band_add(&band, 1, 1, 5.0);
    wb_band_add(&band, 1, 2, 7.0);
    wb_band_add(&band, 2, 1, 7.0);
    wb_band_add(&band, 2, 2, 3.0);
    wb_band_hold(&band, 1, 0.5, b);
    assert_true(wb_band_solve(&band, b));
    assert_close(b[0], 2.0, 1e-15);
    assert_close(b[1], 0.5, 0.0);
    assert_close(b[2], 3.0, 1e-15);
}

static void singular_matrix_is_reported(void **unused)
{
    (void)unused;
    double values[2 * 4], b[2] = {1.0, 1.0};
    struct wb_band band = {.n = 2, .width = 1, .values = values};
    wb_band_clear(&band);
    wb_band_add(&band, 0, 0, 1.0);
    wb_band_add(&band, 0, 1, 1.0);
    wb_band_add(&band, 1, 0, 2.0);
    wb_band_add(&band, 1, 1, 2.0);
    assert_false(wb_band_solve(&band, b));
    wb_band_clear(&band);
    assert_false(wb_band_solve(&band, b));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solution_agrees_with_lapack),
        cmocka_unit_test(held_unknown_has_its_value_and_leaves_the_rest),
        cmocka_unit_test(singular_matrix_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
