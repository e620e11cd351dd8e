#include "base/random.h"
#include "tests/check.h"

static void numbers_depend_on_seed_stream_and_index_only(void **state)
{
    (void)state;
    const uint64_t bits = wb_random_bits(3, 5, 7);
    assert_true(bits == wb_random_bits(3, 5, 7));
    assert_true(bits != wb_random_bits(4, 5, 7));
    assert_true(bits != wb_random_bits(3, 6, 7));
    assert_true(bits != wb_random_bits(3, 5, 8));
    /* Exchanged words must give different numbers. */
    assert_true(wb_random_bits(5, 3, 7) != wb_random_bits(3, 5, 7));
    assert_true(wb_random_bits(3, 7, 5) != wb_random_bits(3, 5, 7));
}

/* Recordings are regenerated from their seeds: these numbers must never change. */
static void known_numbers_stay(void **state)
{
    (void)state;
    assert_true(wb_random_bits(0, 0, 0) == UINT64_C(0x238275bc38fcbe91));
    assert_true(wb_random_bits(1, 2, 3) == UINT64_C(0xd0734750fde362b3));
    assert_close(wb_random_uniform(1, 2, 3), 0.814259011529328, 1e-15);
    assert_close(wb_random_normal(1, 2, 3), 1.6519965649802688, 1e-12);
}

static void uniform_fills_the_unit_interval_evenly(void **state)
{
    (void)state;
    enum {
        N = 100000,
        BINS = 20
    };
    int counts[BINS] = {0};
    double sum = 0.0, squares = 0.0;
    for (uint64_t i = 0; i < N; i++) {
        const double u = wb_random_uniform(42, 1, i);
        assert_true(u >= 0.0 && u < 1.0);
        counts[(int)(u * BINS)]++;
        sum += u;
        squares += u * u;
    }
    assert_close(sum / N, 0.5, 5.0 * sqrt(1.0 / 12.0 / N));
    assert_close(squares / N, 1.0 / 3.0, 5.0 * sqrt(4.0 / 45.0 / N));
    double chi2 = 0.0;
    for (int b = 0; b < BINS; b++)
        chi2 += pow(counts[b] - N / BINS, 2.0) / ((double)N / BINS);
    /* 19 degrees of freedom: a value above 50 has a probability of 1e-4. */
    assert_true(chi2 < 50.0);
}

static void normal_has_the_moments_of_a_normal(void **state)
{
    (void)state;
    enum {
        N = 100000
    };
    double sum = 0.0, squares = 0.0, fourth = 0.0, lagged = 0.0, previous = 0.0;
    for (uint64_t i = 0; i < N; i++) {
        const double x = wb_random_normal(42, 2, i);
        assert_true(isfinite(x));
        sum += x;
        squares += x * x;
        fourth += x * x * x * x;
        lagged += x * previous;
        previous = x;
    }
    assert_close(sum / N, 0.0, 5.0 / sqrt(N));
    assert_close(squares / N, 1.0, 5.0 * sqrt(2.0 / N));
    assert_close(fourth / N, 3.0, 5.0 * sqrt(96.0 / N));
    assert_close(lagged / N, 0.0, 5.0 / sqrt(N));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_depend_on_seed_stream_and_index_only),
        cmocka_unit_test(known_numbers_stay),
        cmocka_unit_test(uniform_fills_the_unit_interval_evenly),
        cmocka_unit_test(normal_has_the_moments_of_a_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
