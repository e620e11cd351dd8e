#include "fe/linear/banded.h"

#include <lapacke.h>
#include <stdlib.h>

#include "tests/fe/rod/wires.h"

enum {
    BLOCKS = 40,
    UNKNOWNS = 3 * BLOCKS,
    BAND = 5,
    ROWS = 3 * BAND + 1
};

/* A random, symmetric, diagonally dominant chain of blocks with the different magnitudes of forces
 * and moments, and the same matrix in LAPACK's band storage, equilibrated: without that, LAPACK's
 * pivoting would lose digits that the chain keeps. */
static const double scale[3] = {1.0, 30.0, 1e-3};

struct chain {
    double diagonal[BLOCKS][9], upper[BLOCKS - 1][9], right[BLOCKS][3];
    double band[UNKNOWNS][ROWS], solution[UNKNOWNS];
};

static void put(struct chain *chain, int row, int column, double value)
{
    chain->band[column][2 * BAND + row - column] = value / (scale[row % 3] * scale[column % 3]);
}

static void make_chain(struct chain *chain, uint64_t *random)
{
    memset(chain, 0, sizeof *chain);
    for (int b = 0; b < BLOCKS; b++) {
        for (int i = 0; i < 3; i++) {
            for (int j = i; j < 3; j++) {
                double value = scale[i] * scale[j] * (test_random(random) - 0.5);
                if (i == j)
                    value += 5.0 * scale[i] * scale[i];
                chain->diagonal[b][3 * i + j] = chain->diagonal[b][3 * j + i] = value;
                put(chain, 3 * b + i, 3 * b + j, value);
                put(chain, 3 * b + j, 3 * b + i, value);
            }
            chain->right[b][i] = scale[i] * (test_random(random) - 0.5);
            chain->solution[3 * b + i] = chain->right[b][i] / scale[i];
            for (int j = 0; j < 3 && b + 1 < BLOCKS; j++) {
                const double value = scale[i] * scale[j] * (test_random(random) - 0.5);
                chain->upper[b][3 * i + j] = value;
                put(chain, 3 * b + i, 3 * b + 3 + j, value);
                put(chain, 3 * b + 3 + j, 3 * b + i, value);
            }
        }
    }
}

static void condensed_solution_agrees_with_lapack(void **unused)
{
    (void)unused;
    uint64_t random = 20260101;
    struct chain *chain = malloc(sizeof *chain);
    assert_non_null(chain);

    for (int trial = 0; trial < 20; trial++) {
        make_chain(chain, &random);
        lapack_int pivots[UNKNOWNS];
        assert_int_equal(LAPACKE_dgbsv(LAPACK_COL_MAJOR, UNKNOWNS, BAND, BAND, 1, chain->band[0],
                                       ROWS, pivots, chain->solution, UNKNOWNS),
                         0);

        double first[BLOCKS][3];
        memcpy(first, chain->right, sizeof first);
        struct wb_banded banded = {BLOCKS, chain->diagonal, chain->upper, chain->right};
        wb_banded_factor(&banded);
        wb_banded_reduce(&banded);
        wb_banded_solve_small(3, 3, chain->diagonal[BLOCKS - 1], chain->right[BLOCKS - 1]);
        wb_banded_expand(&banded);
        /* A second right-hand side with the same factors: half the first. */
        double second[BLOCKS][3];
        for (int i = 0; i < UNKNOWNS; i++)
            second[i / 3][i % 3] = 0.5 * first[i / 3][i % 3];
        const struct wb_banded again = {BLOCKS, chain->diagonal, chain->upper, second};
        wb_banded_reduce(&again);
        memcpy(second[BLOCKS - 1], chain->right[BLOCKS - 1], sizeof second[0]);
        for (int k = 0; k < 3; k++)
            second[BLOCKS - 1][k] *= 0.5;
        wb_banded_expand(&again);
        for (int i = 0; i < UNKNOWNS; i++) {
            const double whole = chain->right[i / 3][i % 3];
            assert_close(second[i / 3][i % 3], 0.5 * whole, 1e-12 * fabs(whole));
        }
        for (int i = 0; i < UNKNOWNS; i++)
            assert_close(chain->right[i / 3][i % 3] * scale[i % 3], chain->solution[i],
                         1e-12 * (1.0 + fabs(chain->solution[i])));
    }
    free(chain);
}

static void inverse_times_matrix_is_one(void **unused)
{
    (void)unused;
    const double A[9] = {4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, -7.0};
    double inverse[9];
    wb_banded_invert(A, inverse);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++)
                sum += inverse[3 * i + k] * A[3 * k + j];
            assert_close(sum, i == j ? 1.0 : 0.0, 1e-15);
        }
    }
}

static void small_system_with_a_zero_on_the_diagonal_is_solved(void **unused)
{
    (void)unused;
    /* Like a tension without stiffness of its own; the row stride is larger than n. */
    double A[12] = {0.0, 1e-6, 1.0, 9.0, 1e-6, 2.0, 3.0, 9.0, 1.0, 3.0, 0.0, 9.0};
    double b[3] = {3.000002, 13.000001, 7.0};
    wb_banded_solve_small(3, 4, A, b);
    assert_close(b[0], 1.0, 1e-12);
    assert_close(b[1], 2.0, 1e-12);
    assert_close(b[2], 3.0, 1e-12);
}

static void singular_system_gives_no_finite_solution(void **unused)
{
    (void)unused;
    double A[4] = {1.0, 2.0, 2.0, 4.0}, b[2] = {1.0, 1.0}, inverse[9];
    const double singular[9] = {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    wb_banded_solve_small(2, 2, A, b);
    assert_false(isfinite(b[0]) && isfinite(b[1]));
    wb_banded_invert(singular, inverse);
    assert_false(isfinite(inverse[0]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(condensed_solution_agrees_with_lapack),
        cmocka_unit_test(inverse_times_matrix_is_one),
        cmocka_unit_test(small_system_with_a_zero_on_the_diagonal_is_solved),
        cmocka_unit_test(singular_system_gives_no_finite_solution),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
