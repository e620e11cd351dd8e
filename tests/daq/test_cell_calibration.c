/* Calibration of a load cell from a series of masses, with readings that have known faults. */
#include <math.h>
#include <string.h>

#include "base/config.h"
#include "base/units.h"
#include "daq/protocol/cell_calibration.h"
#include "tests/check.h"

#define GRAVITY 9.81
#define ERROR 1e-5 /* N, standard error of each reading */

/* Readings of a cell, N: zero, gain, bend (kg of reading at the middle of the span), and what is
 * left of the largest mass on the way down (kg). */
struct cell {
    double zero, gain, bend, left;
};

static int read_masses(const struct cell *cell, const char *text,
                       struct wb_cell_point points[WB_RIG_MASSES])
{
    double masses[WB_RIG_MASSES], largest = 0.0;
    char problem[160];
    const int n = wb_cell_calibration_parse(text, masses, problem, sizeof problem);
    assert_true(n > 0);
    for (int i = 0; i < n; i++)
        largest = fmax(largest, masses[i]);
    for (int i = 0; i < n; i++) {
        const double part = masses[i] / largest;
        const bool down = i > 0 && masses[i] < masses[i - 1];
        const double mass = cell->gain * masses[i] + cell->bend * 4.0 * part * (1.0 - part) +
                            (down ? cell->left : 0.0);
        points[i] = (struct wb_cell_point){.mass = masses[i],
                                           .reading = cell->zero + mass * GRAVITY,
                                           .sd = 10.0 * ERROR,
                                           .n = 100,
                                           .uncertainty = ERROR};
    }
    return n;
}

static struct wb_cell_calibration compute(const struct cell *cell, const char *text)
{
    struct wb_cell_point points[WB_RIG_MASSES];
    struct wb_cell_calibration calibration;
    const int n = read_masses(cell, text, points);
    wb_cell_calibration_compute(&calibration, points, n, GRAVITY, 0.01);
    return calibration;
}

static const char up_and_down[] = "0,2,5,10,20,10,5,2,0";

static void good_cell_passes(void **state)
{
    (void)state;
    const struct wb_cell_calibration c =
        compute(&(struct cell){.zero = 3e-3, .gain = 1.0}, up_and_down);
    assert_true(c.passed);
    assert_close(c.slope, 1.0, 1e-12);
    assert_close(c.span, 20e-3, 1e-15);
    for (int i = 0; i < WB_CELL_QUANTITIES; i++) {
        if (c.results[i].known)
            assert_close(c.results[i].value, 0.0, 1e-12);
    }
}

static void gain_is_the_span(void **state)
{
    (void)state;
    const struct wb_cell_calibration c = compute(&(struct cell){.gain = 1.015}, up_and_down);
    assert_close(c.results[WB_CELL_SPAN].value, 0.015, 1e-12);
    assert_close(c.results[WB_CELL_LINEARITY].value, 0.0, 1e-12);
    assert_false(c.results[WB_CELL_SPAN].passed);
    assert_true(c.results[WB_CELL_LINEARITY].passed);
    assert_false(c.passed);
}

/* The line through (0, 0), (10, 10 + b), (20, 20) has the slope 1 and lies b/3 above the ends. */
static void curvature_is_the_linearity(void **state)
{
    (void)state;
    const double bend = 0.3 * WB_G;
    const struct wb_cell_calibration c =
        compute(&(struct cell){.gain = 1.0, .bend = bend}, "0,10,20");
    assert_close(c.results[WB_CELL_SPAN].value, 0.0, 1e-12);
    assert_close(c.results[WB_CELL_LINEARITY].value, 2.0 / 3.0 * bend / 20e-3, 1e-9);
    assert_close(c.results[WB_CELL_LINEARITY].at, 10e-3, 1e-15);
    assert_close(c.results[WB_CELL_LINEARITY].uncertainty, ERROR / GRAVITY / 20e-3, 1e-12);
    /* Residuals -b/3, 2b/3, -b/3 with one degree of freedom; sum of squares of the masses 200 g2.
     */
    assert_close(c.scatter, sqrt(6.0) / 3.0 * bend, 1e-12);
    assert_close(c.results[WB_CELL_SPAN].uncertainty, c.scatter / sqrt(200e-6), 1e-9);
}

static void residual_in_unloading_is_hysteresis_and_zero_return(void **state)
{
    (void)state;
    const double left = 0.05 * WB_G;
    const struct wb_cell_calibration c =
        compute(&(struct cell){.gain = 1.0, .left = left}, up_and_down);
    assert_close(c.results[WB_CELL_HYSTERESIS].value, left / 20e-3, 1e-9);
    assert_close(c.results[WB_CELL_HYSTERESIS].uncertainty, sqrt(2.0) * ERROR / GRAVITY / 20e-3,
                 1e-12);
    assert_close(c.results[WB_CELL_ZERO_RETURN].value, left / 20e-3, 1e-9);
    assert_close(c.results[WB_CELL_ZERO_RETURN].uncertainty, sqrt(2.0) * ERROR / GRAVITY / 20e-3,
                 1e-12);
    assert_false(c.results[WB_CELL_REPEATABILITY].known);
}

/* 10 g is reached from below three times with errors of 0, +d and -d: a standard deviation of d.
 * The readings of 20 g and 0 are identical. */
static void repeated_masses_give_the_repeatability(void **state)
{
    (void)state;
    struct wb_cell_point points[WB_RIG_MASSES];
    struct wb_cell_calibration c;
    const double d = 0.02 * WB_G;
    const int n = read_masses(&(struct cell){.gain = 1.0}, "0,10,20,0,10,20,0,10,20,0", points);
    points[4].reading += d * GRAVITY;
    points[7].reading -= d * GRAVITY;
    wb_cell_calibration_compute(&c, points, n, GRAVITY, 0.01);
    /* Degrees of freedom: 2 of 10 g, 2 of 20 g, 2 of 0 on the way down. */
    const double expected = sqrt(2.0 * d * d / 6.0) / 20e-3;
    assert_close(c.results[WB_CELL_REPEATABILITY].value, expected, 1e-9);
    assert_close(c.results[WB_CELL_REPEATABILITY].uncertainty, expected / sqrt(12.0), 1e-9);
    assert_false(c.results[WB_CELL_HYSTERESIS].known);
}

static void undetermined_quantities_are_unknown_and_do_not_fail(void **state)
{
    (void)state;
    const struct wb_cell_calibration c = compute(&(struct cell){.gain = 1.0}, "0,10,20");
    assert_false(c.results[WB_CELL_HYSTERESIS].known);
    assert_false(c.results[WB_CELL_REPEATABILITY].known);
    assert_false(c.results[WB_CELL_ZERO_RETURN].known);
    assert_true(c.passed);
}

static void invalid_series_is_rejected_with_the_reason(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"5,10,0", "0 first"}, {"0,10,10,0", "two different masses"},
        {"0,-1,2", "not -1"},  {"0,5 g,10", "not '5 g'"},
        {"0,5,,10", "not ''"}, {"", "not ''"}};
    double masses[WB_RIG_MASSES];
    char problem[160], many[8 * WB_RIG_MASSES] = "0";
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        assert_int_equal(wb_cell_calibration_parse(cases[i][0], masses, problem, sizeof problem),
                         0);
        if (!strstr(problem, cases[i][1]))
            fail_msg("'%s': %s", cases[i][0], problem);
    }
    for (int i = 0; i < WB_RIG_MASSES; i++)
        strcat(many, ",1");
    assert_int_equal(wb_cell_calibration_parse(many, masses, problem, sizeof problem), 0);
    assert_non_null(strstr(problem, "at most"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_cell_passes),
        cmocka_unit_test(gain_is_the_span),
        cmocka_unit_test(curvature_is_the_linearity),
        cmocka_unit_test(residual_in_unloading_is_hysteresis_and_zero_return),
        cmocka_unit_test(repeated_masses_give_the_repeatability),
        cmocka_unit_test(undetermined_quantities_are_unknown_and_do_not_fail),
        cmocka_unit_test(invalid_series_is_rejected_with_the_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
