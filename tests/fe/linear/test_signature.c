/* Signs of eigenvalues against LAPACK's eigenvalues, and of a chain of blocks against the whole. */
#include "fe/linear/signature.h"

#include <lapacke.h>

#include "fe/linear/rod_chain.h"
#include "tests/fe/rod/wires.h"

enum {
    N = WB_SIGNATURE_MOST,
    STRIDE = 8,
    BLOCKS = 5,
    ALL = N * BLOCKS
};

/* Forces and moments. */
static double unit_of(int i)
{
    return i % N < 3 ? 1e3 : 1.0;
}

static void negative_eigenvalues_are_counted(void **unused)
{
    (void)unused;
    uint64_t seed = 5;
    int seen[N + 1] = {0};
    for (int trial = 0; trial < 2000; trial++) {
        double A[N * STRIDE] = {0}, full[N * N], value[N];
        for (int i = 0; i < N; i++) {
            for (int j = 0; j <= i; j++) {
                const double unit = unit_of(i) * unit_of(j), skew = unit * test_random(&seed);
                const double both = unit * (test_random(&seed) - 0.5) +
                                    (i == j ? unit * (3.0 * test_random(&seed) - 1.5) : 0.0);
                /* The skew-symmetric part has no effect. */
                A[STRIDE * i + j] = both + (i == j ? 0.0 : skew);
                A[STRIDE * j + i] = both - (i == j ? 0.0 : skew);
                full[N * i + j] = full[N * j + i] = both;
            }
        }
        assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'L', N, full, N, value), 0);
        int negative = 0;
        for (int i = 0; i < N; i++)
            negative += value[i] < 0.0;
        seen[negative]++;
        assert_int_equal(wb_signature_negative(N, STRIDE, A), negative);
    }
    for (int i = 1; i < N; i++)
        assert_true(seen[i] > 10);
}

static void odd_count_is_the_sign_of_the_determinant(void **unused)
{
    (void)unused;
    uint64_t seed = 7;
    int odd = 0;
    for (int trial = 0; trial < 2000; trial++) {
        double A[N * STRIDE] = {0}, full[N * N], real[N], imaginary[N];
        const int n = 1 + trial % N;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++)
                A[STRIDE * i + j] = full[n * i + j] =
                    unit_of(i) * unit_of(j) * (test_random(&seed) - 0.5);
        }
        assert_int_equal(LAPACKE_dgeev(LAPACK_ROW_MAJOR, 'N', 'N', n, full, n, real, imaginary,
                                       NULL, 1, NULL, 1),
                         0);
        int negative = 0;
        for (int i = 0; i < n; i++)
            negative += imaginary[i] == 0.0 && real[i] < 0.0;
        assert_int_equal(wb_signature_is_odd(n, STRIDE, A), negative % 2 != 0);
        odd += negative % 2;
    }
    assert_in_range(odd, 500, 1500);
}

static void zero_within_round_off_is_not_negative(void **unused)
{
    (void)unused;
    double A[4] = {1.0, 1.0, 1.0, 1.0 - 1e-14};
    assert_int_equal(wb_signature_negative(2, 2, A), 0);
    A[3] = 1.0 - 1e-9;
    assert_int_equal(wb_signature_negative(2, 2, A), 1);
}

/* Inertia is additive over eliminated and remaining unknowns (Haynsworth). */
static void a_chain_counts_like_the_complete_matrix(void **unused)
{
    (void)unused;
    uint64_t seed = 11;
    int most = 0;
    for (int trial = 0; trial < 300; trial++) {
        static double diagonal[BLOCKS][N * N], upper[BLOCKS][N * N], lower[BLOCKS][N * N];
        static double right[BLOCKS][N], full[ALL * ALL], value[ALL];
        struct wb_rod_chain chain = {
            .n = BLOCKS, .diagonal = diagonal, .upper = upper, .lower = lower, .right = right};
        memset(full, 0, sizeof full);
        for (int i = 0; i < ALL; i++) {
            for (int j = 0; j <= i; j++) {
                const int b = i / N, c = j / N, at = N * (i % N) + j % N;
                const double own = i == j ? 6.0 * test_random(&seed) - 1.0 : 0.0;
                const double entry = unit_of(i) * unit_of(j) * (test_random(&seed) - 0.5 + own);
                if (b > c + 1)
                    continue;
                full[ALL * i + j] = entry;
                if (b == c)
                    diagonal[b][at] = diagonal[b][N * (j % N) + i % N] = entry;
                else
                    lower[c][at] = upper[c][N * (j % N) + i % N] = entry;
            }
        }
        assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'L', ALL, full, ALL, value), 0);
        int negative = 0;
        for (int i = 0; i < ALL; i++)
            negative += value[i] < 0.0;
        wb_rod_chain_condense(&chain);
        assert_int_equal(chain.negative + wb_signature_negative(N, N, diagonal[BLOCKS - 1]),
                         negative);
        most = negative > most ? negative : most;
    }
    assert_true(most > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(negative_eigenvalues_are_counted),
        cmocka_unit_test(odd_count_is_the_sign_of_the_determinant),
        cmocka_unit_test(zero_within_round_off_is_not_negative),
        cmocka_unit_test(a_chain_counts_like_the_complete_matrix),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
