/* The tests of a series beside each other: their numbers, mean and spread, and one figure. */
#include "analysis/series_results.h"

#include <stdlib.h>

#include "base/file.h"
#include "base/units.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static double number_at(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    (void)wb_json_get_number(object, key, &value);
    return value;
}

/* Tests without datasets, of these peak forces in mN. */
static void fill(struct wb_series_results *results, int n, const double *peaks)
{
    results->n = n;
    results->tests = calloc((size_t)n, sizeof *results->tests);
    assert_non_null(results->tests);
    for (int i = 0; i < n; i++) {
        struct wb_series_test *const test = &results->tests[i];
        snprintf(test->name, sizeof test->name, "t-%d.wbr", i + 1);
        test->number = test->sample = i + 1;
        for (int k = 0; k < WB_SERIES_QUANTITIES; k++)
            test->values[k] = (double)NAN;
        test->values[WB_SERIES_PEAK_FORCE] = peaks[i] * WB_MN;
    }
}

static void mean_and_spread_are_of_the_tests_that_count(void **state)
{
    (void)state;
    static const double peaks[] = {20.0, 500.0, 22.0, 27.0, (double)NAN};
    struct wb_series_results results = {0};
    struct wb_text text = {0};
    struct wb_json *const root = wb_json_create();
    fill(&results, 5, peaks);
    results.tests[1].excluded =
        (struct wb_index_exclusion){.is_excluded = true, .by = "me", .reason = "it slipped"};
    wb_series_results_describe(&results, root);
    const struct wb_json *const statistics = wb_json_get(root, "statistics");
    const struct wb_json *const peak = wb_json_get(statistics, "peak_force_mN");
    assert_close(number_at(peak, "tests"), 3.0, 0.0);
    assert_close(number_at(peak, "mean"), 23.0, 1e-12);
    assert_close(number_at(peak, "standard_deviation"), sqrt((9.0 + 1.0 + 16.0) / 2.0), 1e-12);
    const struct wb_json *const loop = wb_json_get(statistics, "loop_area_mJ");
    assert_close(number_at(loop, "tests"), 0.0, 0.0);
    assert_true(isnan(number_at(loop, "mean")));
    const struct wb_json *const second = wb_json_item(wb_json_get(root, "tests"), 1);
    assert_close(number_at(second, "peak_force_mN"), 500.0, 1e-9);
    assert_non_null(wb_json_get(second, "excluded"));
    assert_null(wb_json_get(wb_json_item(wb_json_get(root, "tests"), 0), "excluded"));
    wb_series_results_append(&results, &text);
    assert_non_null(strstr(wb_text_string(&text), "  excluded: it slipped\n"));
    assert_non_null(strstr(wb_text_string(&text), "mean                    23.00 "));
    assert_non_null(strstr(wb_text_string(&text), "tests                       3 "));
    wb_text_release(&text);
    wb_json_destroy(root);
    wb_series_results_release(&results);
}

static void one_test_has_no_spread(void **state)
{
    (void)state;
    static const double peaks[] = {20.0};
    struct wb_series_results results = {0};
    struct wb_text text = {0};
    fill(&results, 1, peaks);
    wb_series_results_append(&results, &text);
    assert_non_null(strstr(wb_text_string(&text), "\ns                          -- "));
    wb_text_release(&text);
    wb_series_results_release(&results);
}

/* Against quicklook, and the slope of a cantilever of the rigidity that the report finds for these
 * wires (396 N mm2 for type 1 at 85 mm): 3 EI / L^3 = 1.93 mN/mm. Beyond the first millimetres the
 * wire yields, so the slope over 4.25 mm is smaller. */
static void numbers_are_those_of_the_curve(void **state)
{
    (void)state;
    char path[WB_PATH];
    struct wb_series_results results = {0};
    for (int i = 1; i <= 2; i++) {
        char name[64];
        snprintf(name, sizeof name, "recordings/type1-L85-%d.wbr.zst", i);
        assert_int_equal(wb_file_find_data(path, name), WB_OK);
        assert_non_null(wb_series_results_add(&results, path, i));
    }
    const struct wb_series_test *const test = &results.tests[0];
    assert_true(test->is_usable);
    assert_int_equal(results.tests[1].sample, 2);
    double largest = 0.0, area = 0.0, n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (size_t i = 1; i < test->dataset.n_rows; i++) {
        const struct wb_row *const row = &test->dataset.rows[i], *const before = row - 1;
        if (!wb_series_results_shows(row))
            continue;
        largest = fmax(largest, row->force);
        if (row->phase == WB_PHASE_LOAD && row->deflection <= 0.05 * 85.0 * WB_MM) {
            n += 1.0;
            x += row->deflection;
            y += row->force;
            xx += row->deflection * row->deflection;
            xy += row->deflection * row->force;
        }
        if (wb_series_results_shows(before))
            area += 0.5 * (row->force + before->force) * (row->deflection - before->deflection);
    }
    assert_close(test->values[WB_SERIES_PEAK_FORCE], largest, 1e-12);
    assert_close_relative(test->values[WB_SERIES_LOOP], area, 0.02);
    assert_close_relative(test->values[WB_SERIES_STIFFNESS], (n * xy - x * y) / (n * xx - x * x),
                          0.05);
    const double elastic = 3.0 * 396e-6 / (0.085 * 0.085 * 0.085);
    assert_true(test->values[WB_SERIES_STIFFNESS] < elastic);
    assert_true(test->values[WB_SERIES_STIFFNESS] > 0.6 * elastic);
    /* Where the unloading comes to the force 0, the curve left 0. */
    double left = (double)NAN;
    for (size_t i = 1; i < test->dataset.n_rows && isnan(left); i++) {
        const struct wb_row *const row = &test->dataset.rows[i];
        if (row->cycle == 1 && row->phase == WB_PHASE_UNLOAD && row->force < 0.0)
            left = row->deflection;
    }
    assert_close(test->values[WB_SERIES_RESIDUAL], left, 0.5 * WB_MM);
    char file[WB_PATH];
    results.tests[1].excluded = (struct wb_index_exclusion){.is_excluded = true};
    assert_int_equal(wb_file_join(file, folder, "all.svg"), WB_OK);
    assert_int_equal(wb_series_results_draw(&results, "mine & yours", file), WB_OK);
    char *svg;
    assert_int_equal(wb_file_read(file, &svg, NULL), WB_OK);
    assert_non_null(strstr(svg, "mine &amp; yours, first cycles, measured on a virtual rig"));
    free(svg);
    wb_series_results_release(&results);
}

static void recordings_that_cannot_be_aligned_keep_their_problem(void **state)
{
    (void)state;
    char path[WB_PATH];
    struct wb_series_results results = {0};
    assert_int_equal(wb_file_join(path, folder, "no.wbr"), WB_OK);
    assert_int_equal(wb_file_write(path, "no recording", 12), WB_OK);
    const struct wb_series_test *const test = wb_series_results_add(&results, path, 3);
    assert_non_null(test);
    assert_false(test->is_usable);
    assert_non_null(strstr(test->problem, "no.wbr"));
    assert_true(isnan(test->values[WB_SERIES_PEAK_FORCE]));
    assert_int_equal(wb_series_results_draw(&results, "s", "never.svg"), WB_ERR_DATA);
    wb_series_results_release(&results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mean_and_spread_are_of_the_tests_that_count),
        cmocka_unit_test(one_test_has_no_spread),
        cmocka_unit_test(numbers_are_those_of_the_curve),
        cmocka_unit_test(recordings_that_cannot_be_aligned_keep_their_problem),
    };
    return cmocka_run_group_tests(tests, set_up, remove_folder);
}
