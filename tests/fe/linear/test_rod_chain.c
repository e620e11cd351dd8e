/* Chains of 6 x 6 blocks against LAPACK's general banded solver. */
#include "fe/linear/rod_chain.h"

#include <lapacke.h>
#include <stdlib.h>

#include "tests/fe/rod/wires.h"

enum {
    B = WB_ROD_CHAIN_BLOCK,
    BLOCKS = 9,
    ALL = B * BLOCKS,
    BAND = 2 * B - 1,
    ROWS = 3 * BAND + 1
};

static double diagonal[BLOCKS][B * B], upper[BLOCKS][B * B], lower[BLOCKS][B * B], right[BLOCKS][B];
static double banded[ALL][ROWS], solution[ALL];

static void put(int i, int j, double value)
{
    banded[j][2 * BAND + i - j] = value;
}

/* Random blocks with the very different units of forces and moments. */
static void fill(uint64_t *seed)
{
    memset(banded, 0, sizeof banded);
    for (int b = 0; b < BLOCKS; b++) {
        for (int i = 0; i < B; i++) {
            const double row = i < 3 ? 1e6 : 1.0;
            for (int j = 0; j < B; j++) {
                const double unit = row * (j < 3 ? 1e6 : 1.0);
                const double own = i == j ? 4.0 : 0.0;
                diagonal[b][B * i + j] = unit * (own + test_random(seed) - 0.5);
                upper[b][B * i + j] = unit * (test_random(seed) - 0.5);
                lower[b][B * i + j] = unit * (test_random(seed) - 0.5);
                put(B * b + i, B * b + j, diagonal[b][B * i + j]);
                if (b + 1 < BLOCKS) {
                    put(B * b + i, B * (b + 1) + j, upper[b][B * i + j]);
                    put(B * (b + 1) + i, B * b + j, lower[b][B * i + j]);
                }
            }
            right[b][i] = solution[B * b + i] = row * (test_random(seed) - 0.5);
        }
    }
}

static void elimination_is_the_general_solution(void **unused)
{
    (void)unused;
    uint64_t seed = 23;
    double worst = 0.0;
    for (int trial = 0; trial < 20; trial++) {
        lapack_int pivots[ALL];
        struct wb_rod_chain chain = {BLOCKS, diagonal, upper, lower, right};
        fill(&seed);
        assert_int_equal(LAPACKE_dgbsv(LAPACK_COL_MAJOR, ALL, BAND, BAND, 1, banded[0], ROWS,
                                       pivots, solution, ALL),
                         0);
        wb_rod_chain_condense(&chain);
        double rows[B][WB_ROD_CHAIN_WIDTH] = {{0}};
        for (int i = 0; i < B; i++) {
            memcpy(rows[i], diagonal[BLOCKS - 1] + B * i, B * sizeof(double));
            rows[i][B] = right[BLOCKS - 1][i];
        }
        wb_rod_chain_solve(rows, 1);
        for (int i = 0; i < B; i++)
            right[BLOCKS - 1][i] = rows[i][B];
        wb_rod_chain_expand(&chain);
        for (int k = 0; k < ALL; k++) {
            const double unit = k % B < 3 ? 1e-6 : 1.0;
            worst = fmax(worst, fabs(right[k / B][k % B] - solution[k]) / unit);
        }
    }
    print_message("against dgbsv: %.2g\n", worst);
    assert_true(worst < 1e-11);
}

static void a_zero_pivot_is_avoided(void **unused)
{
    (void)unused;
    /* A permutation: every diagonal entry is zero. */
    double rows[B][WB_ROD_CHAIN_WIDTH] = {{0}};
    for (int i = 0; i < B; i++) {
        rows[i][(i + 1) % B] = i + 1.0;
        rows[i][B] = 2.0 * (i + 1.0);
    }
    wb_rod_chain_solve(rows, 1);
    for (int i = 0; i < B; i++)
        assert_close(rows[i][B], 2.0, 1e-15);
}

static void a_singular_block_is_not_finite(void **unused)
{
    (void)unused;
    double rows[B][WB_ROD_CHAIN_WIDTH] = {{0}};
    for (int i = 0; i < B; i++)
        rows[i][i] = i == 3 ? 0.0 : 1.0;
    rows[3][B] = 1.0;
    wb_rod_chain_solve(rows, 1);
    assert_false(isfinite(rows[3][B]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elimination_is_the_general_solution),
        cmocka_unit_test(a_zero_pivot_is_avoided),
        cmocka_unit_test(a_singular_block_is_not_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
