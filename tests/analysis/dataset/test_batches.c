#include "analysis/dataset/batches.h"

#include "base/random.h"
#include "tests/check.h"

static const double level = 0.02;

/* How many of so many samples of n are called two batches; every second number is `apart` larger.
 */
static int count(int n, double apart, int samples)
{
    int called = 0;
    double x[32];
    for (int i = 0; i < samples; i++) {
        for (int k = 0; k < n; k++)
            x[k] = wb_random_normal(7, (uint64_t)i, (uint64_t)k) + (k % 2) * apart;
        called += wb_batches_find(x, n, level).are_two;
    }
    return called;
}

static void one_population_is_called_two_as_often_as_stated(void **unused)
{
    (void)unused;
    enum {
        SAMPLES = 200
    };
    static const int sizes[] = {5, 6, 10, 15};
    int all = 0;
    for (int i = 0; i < 4; i++) {
        const int called = count(sizes[i], 0.0, SAMPLES);
        print_message("    %d numbers: %d of %d\n", sizes[i], called, SAMPLES);
        all += called;
    }
    /* 2 % of 800 are 16, with a standard deviation of 4. */
    assert_in_range(all, 4, 28);
}

/* 15 % apart with a scatter of 2, 3 and 4 %. */
static void two_batches_are_told(void **unused)
{
    (void)unused;
    enum {
        SAMPLES = 100
    };
    static const struct {
        int n;
        double apart, least;
    } cases[] = {{6, 7.5, 0.45}, {10, 5.0, 0.35}, {10, 7.5, 0.9}, {20, 5.0, 0.85}};
    for (int i = 0; i < 4; i++) {
        const double found = count(cases[i].n, cases[i].apart, SAMPLES) / (double)SAMPLES;
        print_message("    %d numbers, %.2f standard deviations apart: %.0f %%\n", cases[i].n,
                      cases[i].apart, 100.0 * found);
        assert_true(found >= cases[i].least);
    }
}

static void the_groups_are_those_of_the_gap(void **unused)
{
    (void)unused;
    static const double x[] = {1.02, 1.16, 1.0, 1.15, 0.99, 1.17, 1.01};
    const struct wb_batches found = wb_batches_find(x, 7, level);
    assert_true(found.are_two && found.ratio > found.limit);
    assert_close(found.border, 0.5 * (1.02 + 1.15), 1e-12);
    assert_close(found.apart, 1.16 - 1.005, 1e-12);
    assert_false(wb_batches_find(x, WB_BATCHES_LEAST - 1, level).are_two);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_population_is_called_two_as_often_as_stated),
        cmocka_unit_test(two_batches_are_told),
        cmocka_unit_test(the_groups_are_those_of_the_gap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
