#include "analysis/predict/ranking.h"

#include "analysis/predict/hypercube.h"
#include "base/random.h"
#include "tests/check.h"

enum {
    N = 500,
    COLUMNS = 5,
    GROUPS = 4
};

static double columns[N * COLUMNS], result[N];
static const int group[COLUMNS] = {0, 1, 1, 2, 3};
static struct wb_ranking ranking;

static void make_columns(void)
{
    wb_hypercube_fill(9, N, COLUMNS, columns);
    for (int i = 0; i < N; i++)
        columns[i * COLUMNS + 4] = 0.25; /* does not vary */
}

static enum wb_status compute(int n)
{
    const struct wb_ranking_data data = {
        .n = n,
        .n_columns = COLUMNS,
        .n_groups = GROUPS,
        .columns = columns,
        .group = group,
        .result = result,
        .seed = 3,
    };
    return wb_ranking_compute(&ranking, &data);
}

/* y = 3 a + 2 b1 + b2 + 2 c of uniform numbers: shares of the variance are 9, 5 and 4 of 18. Ranks
 * of a sum are not the sum of ranks, which changes shares by a few per cent. */
static void shares_of_a_linear_function_are_those_of_its_variance(void **state)
{
    (void)state;
    make_columns();
    for (int i = 0; i < N; i++) {
        const double *const x = columns + (size_t)i * COLUMNS;
        result[i] = 3.0 * x[0] + 2.0 * x[1] + x[2] + 2.0 * x[3];
    }
    assert_int_equal(compute(N), WB_OK);
    assert_true(ranking.is_valid);
    print_message("R2 %.4f\n", ranking.r2);
    assert_true(ranking.r2 > 0.95 && ranking.r2 <= 1.0);
    assert_int_equal(ranking.n_groups, 3);
    static const int order[] = {0, 1, 2};
    static const double share[] = {9.0 / 18.0, 5.0 / 18.0, 4.0 / 18.0};
    double sum = 0.0;
    for (int g = 0; g < 3; g++) {
        const struct wb_ranking_share *const s = &ranking.group[g];
        print_message("group %d: %.4f (%.4f to %.4f), variance %.4f\n", s->group, s->share, s->low,
                      s->high, share[g]);
        assert_int_equal(s->group, order[g]);
        assert_close(s->share, share[g], 0.035);
        assert_true(s->low < s->share && s->share < s->high && s->high - s->low < 0.15);
        sum += s->share;
    }
    assert_close(sum, ranking.r2, 0.01);
}

static void a_steep_monotonic_function_has_the_same_ranks(void **state)
{
    (void)state;
    struct wb_ranking linear;
    shares_of_a_linear_function_are_those_of_its_variance(NULL);
    linear = ranking;
    for (int i = 0; i < N; i++)
        result[i] = exp(5.0 * result[i]);
    assert_int_equal(compute(N), WB_OK);
    assert_memory_equal(&ranking, &linear, sizeof ranking);
}

static void dependent_columns_are_counted_once(void **state)
{
    (void)state;
    make_columns();
    for (int i = 0; i < N; i++) {
        double *const x = columns + (size_t)i * COLUMNS;
        x[2] = -x[1]; /* the same ranks in reverse */
        result[i] = x[0] + x[1];
    }
    assert_int_equal(compute(N), WB_OK);
    assert_true(ranking.is_valid);
    assert_close(ranking.group[0].share, 0.5, 0.03);
    assert_close(ranking.group[1].share, 0.5, 0.03);
    assert_close(ranking.group[2].share, 0.0, 0.01);
}

/* Half of the variance comes from none of the inputs: R2 is about 0.5, within its interval. */
static void results_that_inputs_do_not_explain_are_not_ranked(void **state)
{
    (void)state;
    make_columns();
    for (int i = 0; i < N; i++)
        result[i] = columns[(size_t)i * COLUMNS] + wb_random_uniform(1, 1, (uint64_t)i);
    assert_int_equal(compute(N), WB_OK);
    assert_false(ranking.is_valid);
    assert_close(ranking.r2, 0.5, 0.08);
    assert_true(ranking.low < ranking.r2 && ranking.r2 < ranking.high);
}

/* Over 100 samples of a function with noise, the interval contains the share of a very large sample
 * in about nine of ten. */
static void the_interval_contains_the_share_in_nine_of_ten_samples(void **state)
{
    (void)state;
    enum {
        SAMPLES = 100,
        SIZE = 100
    };
    int within = 0;
    for (int s = 0; s < SAMPLES; s++) {
        for (int i = 0; i < SIZE; i++) {
            double *const x = columns + (size_t)i * COLUMNS;
            for (int c = 0; c < COLUMNS; c++)
                x[c] = wb_random_normal((uint64_t)s, (uint64_t)c, (uint64_t)i);
            result[i] = 2.0 * x[0] + x[3] + x[1] + wb_random_normal((uint64_t)s, 50, (uint64_t)i);
        }
        assert_int_equal(compute(SIZE), WB_OK);
        for (int g = 0; g < ranking.n_groups; g++)
            if (ranking.group[g].group ==
                0) /* 4/7 of the variance; of normal ranks (6/pi asin(sqrt(4/7)/2))^2 */
                within += ranking.group[g].low < 0.548 && ranking.group[g].high > 0.548;
    }
    print_message("%d of %d\n", within, SAMPLES);
    assert_true(within >= 80 && within <= 98);
}

/* u is uniform on 0 to 1 and set to zero below 0.8: tied ranks are 0.4, their mean, and R2 is
 * 0.4880 (with the smallest of the tied ranks, 0, it would be 0.4865). */
static void equal_results_share_their_mean_rank(void **state)
{
    (void)state;
    make_columns();
    for (int i = 0; i < N; i++) {
        const double u = columns[(size_t)i * COLUMNS];
        result[i] = u < 0.8 ? 0.0 : u;
        for (int c = 1; c < COLUMNS; c++)
            columns[(size_t)i * COLUMNS + (size_t)c] = 0.0;
    }
    assert_int_equal(compute(N), WB_OK);
    assert_close(ranking.r2, 0.4880, 4e-4);
}

static void too_few_runs_are_rejected(void **state)
{
    (void)state;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(compute(COLUMNS + 3), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_of_a_linear_function_are_those_of_its_variance),
        cmocka_unit_test(a_steep_monotonic_function_has_the_same_ranks),
        cmocka_unit_test(dependent_columns_are_counted_once),
        cmocka_unit_test(results_that_inputs_do_not_explain_are_not_ranked),
        cmocka_unit_test(the_interval_contains_the_share_in_nine_of_ten_samples),
        cmocka_unit_test(equal_results_share_their_mean_rank),
        cmocka_unit_test(too_few_runs_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
