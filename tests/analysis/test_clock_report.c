/* The report of a recording's clocks, on made-up recordings whose lag is known. With the argument
 * `many`: of 100 seeds instead of 20. */
#include "analysis/clock_report.h"

#include <string.h>

#include "base/file.h"
#include "base/units.h"
#include "tests/analysis/synthetic.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

#define MS 1e-3
#define EXPECTED (50.0 * MS) /* the rig file's delay */

static int n_seeds = 20, n_recordings;
static struct syn syn;
static struct wb_clock_report report;

static int start(void **state)
{
    keep_messages();
    return make_folder(state);
}

static int begin(void **state)
{
    (void)state;
    syn_default(&syn);
    syn.travel = 10e-3;
    memset(&report, 0, sizeof report);
    return 0;
}

static int end(void **state)
{
    (void)state;
    wb_clock_report_release(&report);
    return 0;
}

static void make(void)
{
    char path[WB_PATH];
    snprintf(path, WB_PATH, "%s/clock-%d.wbr", folder, ++n_recordings);
    syn_record(&syn, path);
    wb_clock_report_release(&report);
    if (wb_clock_report_make(&report, path) != WB_OK)
        fail_msg("no report: %s", kept.last);
    unlink(path);
}

static void the_interval_covers_the_lag(void **state)
{
    (void)state;
    int covered = 0;
    double error = 0.0; /* s, sum */
    for (int seed = 1; seed <= n_seeds; seed++) {
        syn.another = (uint64_t)seed;
        syn.late = (seed % 5) * 10.0 * MS;
        make();
        assert_true(report.identifiable);
        assert_true(report.uncertainty < 50.0 * MS);
        const double lag = EXPECTED + syn.late;
        error += report.lag - lag;
        covered += report.interval[0] <= lag && lag <= report.interval[1];
    }
    print_message("the interval covers the lag in %d of %d recordings, mean error %.1f ms\n",
                  covered, n_seeds, error / n_seeds / MS);
    assert_true(covered * 100 >= 85 * n_seeds);
}

static void more_reversals_make_the_lag_certain(void **state)
{
    (void)state;
    make();
    const double one = report.uncertainty;
    assert_int_equal(report.n_reversals, 1);
    syn.cycles = 4;
    make();
    assert_int_equal(report.n_reversals, 4);
    assert_true(report.uncertainty < 0.8 * one);
    assert_true(report.interval[0] <= EXPECTED && EXPECTED <= report.interval[1]);
}

/* The lag is measured where the tip stops and where it starts again. */
static void the_lag_is_found_with_a_dwell_at_the_turn(void **state)
{
    static const double dwells[] = {0.3, 0.9, 2.0, 10.0};
    (void)state;
    syn.late = 20.0 * MS;
    syn.cycles = 2;
    for (size_t i = 0; i < sizeof dwells / sizeof dwells[0]; i++) {
        syn.dwell = dwells[i];
        make();
        assert_true(report.n_reversals >= 2);
        assert_true(report.identifiable);
        assert_close(report.lag, EXPECTED + 20.0 * MS, 3.0 * report.uncertainty);
        assert_true(report.uncertainty < 15.0 * MS);
    }
}

/* With hardly any noise the measured lag is the truth's to a quarter of a frame, and what differs
 * from the rig file is reported. */
static void a_delay_missing_in_the_rig_file_is_reported(void **state)
{
    (void)state;
    struct wb_text text = {0};
    syn.marker_noise = 5e-6;
    syn.force_noise = 5e-6;
    make();
    assert_close(report.lag, EXPECTED, 2.0 * MS);
    assert_true(report.agrees);
    syn.late = 60.0 * MS;
    make();
    assert_close(report.lag, EXPECTED + 60.0 * MS, 2.0 * MS);
    assert_false(report.agrees);
    wb_clock_report_format(&report, &text);
    assert_non_null(strstr(wb_text_string(&text), "NOT AS EXPECTED"));
    wb_text_release(&text);
}

/* The stated sensitivity against the area of the same test with a force that is really late. */
static void the_area_changes_with_the_lag_as_stated(void **state)
{
    (void)state;
    syn.marker_noise = 5e-6;
    syn.force_noise = 5e-6;
    make();
    const double area = report.area, slope = report.area_per_delay;
    const double low = report.area_interval[0], from = report.interval[0];
    assert_close(low, area + slope * (from - EXPECTED), 1e-12);
    syn.late = 20.0 * MS;
    make();
    /* A force that is 20 ms late is one whose delay was taken off 20 ms too little. */
    const double change = report.area - area;
    assert_true(fabs(change) > 0.5e-6);
    assert_close(change, -slope * syn.late, 0.1 * fabs(change));
}

static void the_drift_of_the_cameras_is_found(void **state)
{
    (void)state;
    struct wb_json *const object = wb_json_create();
    double skew, offset, scatter;
    syn.skew = 80e-6;
    make();
    wb_clock_report_describe(&report, object);
    const struct wb_json *const clock = wb_json_item(wb_json_get(object, "camera_clock"), 0);
    assert_true(wb_json_get_number(clock, "skew_ppm", &skew));
    assert_true(wb_json_get_number(clock, "offset_s", &offset));
    assert_true(wb_json_get_number(wb_json_get(object, "load_cell_stream"), "arrival_scatter_ms",
                                   &scatter));
    /* The host runs 1/(1 - 80 ppm) as fast as the server. */
    assert_close(skew, 80.0, 10.0);
    /* 5000 s is bench time 0, when the server shows its zero and 100 s (less 80 ppm). */
    assert_close(offset, 5000.0 - (syn.server_zero + 100.0), 0.05);
    /* Late by 2 ms times the square of a uniform number: the median is 0.5 ms. */
    assert_close(scatter, 0.5, 0.1);
    wb_json_destroy(object);
}

static void without_a_reversal_the_lag_is_not_identifiable(void **state)
{
    (void)state;
    struct wb_text text = {0};
    syn.only_down = true;
    make();
    assert_false(report.identifiable);
    assert_false(isfinite(report.lag));
    wb_clock_report_format(&report, &text);
    assert_non_null(strstr(wb_text_string(&text), "not identifiable: no reversal"));
    wb_text_release(&text);
}

static void too_little_force_leaves_the_lag_unknown(void **state)
{
    (void)state;
    syn.force_noise = 2e-3;
    make();
    assert_false(report.identifiable);
    assert_non_null(strstr(report.reason, "uncertainty"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, begin, end)

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "many") == 0)
        n_seeds = 100;
    const struct CMUnitTest tests[] = {
        TEST(the_interval_covers_the_lag),
        TEST(more_reversals_make_the_lag_certain),
        TEST(the_lag_is_found_with_a_dwell_at_the_turn),
        TEST(a_delay_missing_in_the_rig_file_is_reported),
        TEST(the_area_changes_with_the_lag_as_stated),
        TEST(the_drift_of_the_cameras_is_found),
        TEST(without_a_reversal_the_lag_is_not_identifiable),
        TEST(too_little_force_leaves_the_lag_unknown),
    };
    return cmocka_run_group_tests(tests, start, remove_folder);
}
