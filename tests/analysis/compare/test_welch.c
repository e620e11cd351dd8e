/* Welch's interval compared with published and closed-form values, and the error rate of its
 * verdicts on synthetic specimens. */
#include "tests/check.h"

#include "analysis/compare/welch.h"
#include "base/config.h"
#include "base/random.h"

static struct wb_welch_group group_of(const double *x, int n)
{
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++)
        sum += x[i];
    for (int i = 0; i < n; i++)
        squares += (x[i] - sum / n) * (x[i] - sum / n);
    return (struct wb_welch_group){
        .mean = sum / n, .deviation = sqrt(squares / (n - 1)), .n = n, .degrees = n - 1};
}

/* Student's sleep data. R's t.test(extra ~ group) gives: t = -1.8608, df = 17.776, 95 percent
 * confidence interval -3.3654832 to 0.2054832 of the first minus the second. */
static void interval_matches_that_of_r(void **state)
{
    (void)state;
    static const double first[] = {0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
    static const double second[] = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
    const struct wb_welch_group a = group_of(first, 10), b = group_of(second, 10);
    const struct wb_welch w = wb_welch_find(&a, &b, 0.025);
    assert_close(w.difference / w.error, 1.8608, 5e-5);
    assert_close(w.degrees, 17.776, 5e-4);
    assert_close(w.low, -0.2054832, 5e-8);
    assert_close(w.high, 3.3654832, 5e-8);
}

/* Two groups of n specimens with equal scatter have 2 (n - 1) degrees of freedom together. For two
 * degrees of freedom the quantile of Student's t has the closed form (2 p - 1) / sqrt(2 p (1 - p)).
 */
static void groups_with_equal_scatter_add_their_degrees_of_freedom(void **state)
{
    (void)state;
    const struct wb_welch_group a = {.mean = 1.0, .deviation = 0.3, .n = 2, .degrees = 1};
    const struct wb_welch_group b = {.mean = 1.5, .deviation = 0.3, .n = 2, .degrees = 1};
    const struct wb_welch w = wb_welch_find(&a, &b, 0.05);
    const double p = 0.95, t = (2.0 * p - 1.0) / sqrt(2.0 * p * (1.0 - p));
    assert_close(w.degrees, 2.0, 1e-12);
    assert_close(w.error, 0.3, 1e-15);
    assert_close(w.high - w.difference, t * 0.3, 1e-9);
    assert_close(w.difference - w.low, t * 0.3, 1e-9);
}

/* If one group has no scatter, the degrees of freedom are those of the other group. */
static void group_without_scatter_adds_no_degrees_of_freedom(void **state)
{
    (void)state;
    const struct wb_welch_group a = {.deviation = 0.2, .n = 4, .degrees = 3};
    const struct wb_welch_group b = {.deviation = 0.0, .n = 9, .degrees = 8};
    assert_close(wb_welch_find(&a, &b, 0.05).degrees, 3.0, 1e-12);
    const struct wb_welch none = wb_welch_find(&b, &b, 0.05);
    assert_close(none.high - none.low, 0.0, 0.0);
    assert_int_equal(wb_welch_decide(&none, 0.1), WB_GROUPS_EQUIVALENT);
}

static void verdict_follows_from_the_interval(void **state)
{
    (void)state;
    static const struct {
        double low, high;
        enum wb_verdict_of_groups verdict;
    } cases[] = {
        {-0.1, 0.1, WB_GROUPS_EQUIVALENT},   {-0.05, 0.02, WB_GROUPS_EQUIVALENT},
        {0.02, 0.11, WB_GROUPS_UNDECIDED},   {-0.11, 0.02, WB_GROUPS_UNDECIDED},
        {-0.3, 0.3, WB_GROUPS_UNDECIDED},    {0.11, 0.2, WB_GROUPS_DIFFERENT},
        {-0.2, -0.101, WB_GROUPS_DIFFERENT}, {0.1, 0.2, WB_GROUPS_UNDECIDED},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        const struct wb_welch w = {.low = cases[i].low, .high = cases[i].high};
        assert_int_equal(wb_welch_decide(&w, 0.1), cases[i].verdict);
    }
}

/* --- synthetic batches --- */

enum {
    TRIALS = 20000
};

/* Two batches of specimens whose means differ by `difference`. */
struct batches {
    double difference, deviation[2];
    int n[2];
};

static struct wb_welch_group draw(const struct batches *of, int side, int trial)
{
    double x[200];
    for (int i = 0; i < of->n[side]; i++)
        x[i] = side * of->difference +
               of->deviation[side] * wb_random_normal(7, (uint64_t)(2 * trial + side), (uint64_t)i);
    return group_of(x, of->n[side]);
}

struct rates {
    double verdict[3]; /* share of the trials */
    double covered;    /* share of the intervals that contain the true difference */
};

static struct rates simulate(const struct batches *of, double limit)
{
    struct rates rates = {.covered = 0.0};
    for (int trial = 0; trial < TRIALS; trial++) {
        const struct wb_welch_group a = draw(of, 0, trial), b = draw(of, 1, trial);
        const struct wb_welch w = wb_welch_find(&a, &b, 0.05);
        rates.verdict[wb_welch_decide(&w, limit)] += 1.0 / TRIALS;
        rates.covered += (w.low <= of->difference && of->difference <= w.high) / (double)TRIALS;
    }
    return rates;
}

/* Three standard errors of 20,000 trials are 0.005 at 5 %, 0.0064 at 10 %. For groups this
 * small and this different, Welch's approximation itself is wrong by up to 0.01. */
static void at_most_one_verdict_in_twenty_is_wrong(void **state)
{
    (void)state;
    static const struct batches cases[] = {
        {0.1, {0.02, 0.02}, {3, 3}}, {0.1, {0.05, 0.05}, {6, 6}},   {0.1, {0.01, 0.04}, {3, 8}},
        {0.1, {0.04, 0.01}, {3, 8}}, {-0.1, {0.03, 0.03}, {5, 10}},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        /* The true difference equals the limit. Both verdicts are then wrong, at their highest
         * rates. */
        const struct rates rates = simulate(&cases[i], 0.1);
        assert_true(rates.verdict[WB_GROUPS_EQUIVALENT] <= 0.065);
        assert_true(rates.verdict[WB_GROUPS_DIFFERENT] <= 0.065);
        assert_close(rates.covered, 0.9, 0.025);
    }
}

static void batches_with_little_scatter_are_distinguished(void **state)
{
    (void)state;
    const struct batches alike = {0.0, {0.02, 0.02}, {5, 5}}, unlike = {0.2, {0.02, 0.02}, {5, 5}};
    assert_true(simulate(&alike, 0.1).verdict[WB_GROUPS_EQUIVALENT] > 0.99);
    assert_true(simulate(&unlike, 0.1).verdict[WB_GROUPS_DIFFERENT] > 0.99);
}

/* With the stated number of additional specimens 80 % of the comparisons reach the correct verdict,
 * if the true means and scatter are those found. With half that number fewer than 75 % do. */
static void stated_number_of_specimens_is_sufficient_in_four_of_five_comparisons(void **state)
{
    (void)state;
    static const struct {
        double difference, deviation;
    } cases[] = {{0.0, 0.10}, {0.05, 0.08}, {0.16, 0.10}, {-0.04, 0.12}};
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        const struct wb_welch_group a = {
            .mean = 0.0, .deviation = cases[i].deviation, .n = 3, .degrees = 2};
        struct wb_welch_group b = a;
        b.mean = cases[i].difference;
        const int more = wb_welch_more(&a, &b, 0.05, 0.1);
        assert_in_range(more, 4, 190);
        struct batches batches = {
            cases[i].difference, {cases[i].deviation, cases[i].deviation}, {3 + more, 3 + more}};
        const enum wb_verdict_of_groups correct =
            fabs(cases[i].difference) < 0.1 ? WB_GROUPS_EQUIVALENT : WB_GROUPS_DIFFERENT;
        const double decided = simulate(&batches, 0.1).verdict[correct];
        assert_true(decided > 0.77 && decided < 0.83);
        batches.n[0] = batches.n[1] = 3 + more / 2;
        assert_true(simulate(&batches, 0.1).verdict[correct] < 0.75);
    }
}

static void no_number_of_specimens_is_sufficient_for_a_difference_at_the_limit(void **state)
{
    (void)state;
    const struct wb_welch_group a = {.mean = 0.0, .deviation = 0.1, .n = 3, .degrees = 2};
    const struct wb_welch_group b = {.mean = 0.1, .deviation = 0.1, .n = 3, .degrees = 2};
    assert_int_equal(wb_welch_more(&a, &b, 0.05, 0.1), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interval_matches_that_of_r),
        cmocka_unit_test(groups_with_equal_scatter_add_their_degrees_of_freedom),
        cmocka_unit_test(group_without_scatter_adds_no_degrees_of_freedom),
        cmocka_unit_test(verdict_follows_from_the_interval),
        cmocka_unit_test(at_most_one_verdict_in_twenty_is_wrong),
        cmocka_unit_test(batches_with_little_scatter_are_distinguished),
        cmocka_unit_test(stated_number_of_specimens_is_sufficient_in_four_of_five_comparisons),
        cmocka_unit_test(no_number_of_specimens_is_sufficient_for_a_difference_at_the_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
