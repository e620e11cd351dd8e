/* Synchronization of two clocks: known lags are found, and no lag is given if the signals do not
 * show one. */
#include "analysis/import/sync.h"

#include <stdlib.h>

#include <gsl/gsl_errno.h>

#include "tests/check.h"

#define LAG (-41.37) /* s: time on the motion's clock less that on the force's */
#define MOST 20000

static double motion_t[MOST], motion_x[MOST], shake_x[MOST], force_t[MOST], force_x[MOST];

/* State of the bench at time t of the motion's clock. */
struct bench {
    double (*deflection)(double t); /* m */
    double (*tap)(double t);        /* m, for a moment; NULL: none */
    double noise, force_noise;      /* m, N */
    double filter;                  /* s: first order */
    double end;                     /* s */
    double relaxes;                 /* part of the force that relaxes while the wire is at rest */
    uint64_t seed;
};

static uint64_t random_state;

static double noise(void)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        sum += (double)(random_state >> 11) / 9007199254740992.0;
    }
    return sum;
}

/* A wire that softens: force over deflection, with stiffer unloading; `highest` is the largest
 * deflection so far. */
static double force_of(const struct bench *bench, double t, double highest)
{
    const double u = bench->deflection(t);
    const double up = 2.0 * highest - 12.0 * highest * highest;
    const double tap = bench->tap ? bench->tap(t) : 0.0;
    const double rested = bench->relaxes > 0.0 ? fmin(fmax(t - 33.0, 0.0), 3.0) : 0.0;
    return up * (1.0 - bench->relaxes * rested / (1.0 + rested)) - 2.3 * (highest - u) + 2.0 * tap;
}

static void run(const struct bench *bench, const struct wb_sync_settings *settings,
                struct wb_sync *sync)
{
    size_t n = 0, m = 0;
    random_state = bench->seed;
    for (; n < MOST && (double)n / 120.0 < bench->end; n++) {
        const double t = motion_t[n] = (double)n / 120.0;
        motion_x[n] =
            bench->deflection(t) + (bench->tap ? bench->tap(t) : 0.0) + bench->noise * noise();
    }
    /* The force's clock: 80 readings a second, filtered. */
    const int fine = 50;
    const double step = 1.0 / 80.0 / fine;
    const double part = bench->filter > 0.0 ? 1.0 - exp(-step / bench->filter) : 1.0;
    double filtered = force_of(bench, 0.0, 0.0), highest = 0.0;
    for (int i = 0; i * step < bench->end && m < MOST; i++) {
        const double t = i * step;
        highest = fmax(highest, bench->deflection(t));
        filtered += part * (force_of(bench, t, highest) - filtered);
        if (i % fine != 0)
            continue;
        force_t[m] = t - LAG;
        force_x[m++] = -0.3 + filtered + bench->force_noise * noise();
    }
    const struct wb_signal motion = {motion_t, motion_x, n};
    const struct wb_signal force = {force_t, force_x, m};
    wb_signal_shake(&motion, shake_x);
    const struct wb_signal shake = {motion_t, shake_x, n};
    wb_sync_find(sync, &motion, &shake, &force, settings);
}

static const struct wb_sync_settings both = {.tap = true, .reversal = true};

static double up_and_down(double t)
{
    return 1e-3 * fmax(0.0, t < 33.0 ? t - 3.0 : 63.0 - t);
}

static double with_a_rest(double t)
{
    return 1e-3 * fmax(0.0, t < 33.0 ? t - 3.0 : t < 36.0 ? 30.0 : 66.0 - t);
}

/* As if the stage waits for its next command. */
static double with_a_moment(double t)
{
    return 1e-3 * fmax(0.0, t < 33.0 ? t - 3.0 : t < 33.12 ? 30.0 : 63.12 - t);
}

static double only_up(double t)
{
    return 1e-3 * fmax(0.0, t - 3.0);
}

static double three_cycles(double t)
{
    const double in = fmod(fmax(t - 3.0, 0.0), 40.0);
    return t > 123.0 ? 0.0 : 1e-3 * (in < 20.0 ? in : 40.0 - in);
}

static double tap_at_1_7(double t)
{
    return fabs(t - 1.7) < 0.05 ? 1.5e-3 * cos((t - 1.7) * M_PI / 0.1) : 0.0;
}

static double slow(double t)
{
    return 0.1e-3 * fmax(0.0, t < 63.0 ? t - 3.0 : 123.0 - t);
}

static void a_reversal_gives_the_lag(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {up_and_down, NULL, 5e-5, 1e-4, 0.0, 70.0};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_REVERSAL);
    assert_int_equal(sync.n_events, 1);
    assert_true(sync.uncertainty < 0.05);
    assert_close(sync.lag, LAG, 3.0 * sync.uncertainty);
    assert_close(sync.first_event, 33.0, 0.05);
}

static void a_reversal_after_a_rest_gives_the_lag(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {with_a_rest, NULL, 5e-5, 1e-4, 0.0, 70.0};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_REVERSAL);
    assert_close(sync.lag, LAG, 3.0 * sync.uncertainty + 0.01);
    assert_close(sync.first_event, 33.0, 0.1);
}

/* The force relaxes by a tenth while the motion rests. */
static void a_wire_that_relaxes_at_rest_gives_the_lag(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {with_a_rest, NULL, 2e-5, 4e-5, 0.0, 70.0, .relaxes = 0.1};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_REVERSAL);
    assert_close(sync.lag, LAG, 2.0 * sync.uncertainty);
    assert_true(sync.uncertainty < 0.1);
}

/* Unloading is steeper, so that the force has its corner nearer to the end of the rest. */
static void a_stage_that_waits_before_turning_does_not_bias_the_lag(void **state)
{
    (void)state;
    struct wb_sync_settings settings = both;
    settings.filter_delay = 0.05;
    double error = 0.0;
    const int n = 6;
    int covered = 0;
    for (int i = 0; i < n; i++) {
        struct wb_sync sync;
        const struct bench bench = {with_a_moment, NULL, 2e-5, 5e-5, 0.05, 70.0, .seed = 77u * i};
        run(&bench, &settings, &sync);
        assert_int_equal(sync.method, WB_SYNC_REVERSAL);
        error += (sync.lag - (LAG - 0.05)) / n;
        covered += fabs(sync.lag - (LAG - 0.05)) < 2.0 * sync.uncertainty;
    }
    print_message("mean error %.1f ms, %d of %d within two deviations\n", 1e3 * error, covered, n);
    assert_close(error, 0.0, 6e-3);
    assert_true(covered >= n - 1);
}

static void a_slow_reversal_gives_a_larger_uncertainty(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {slow, NULL, 3e-5, 5e-5, 0.0, 130.0};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_REVERSAL);
    assert_close(sync.lag, LAG, 3.0 * sync.uncertainty);
}

/* The lag from events includes the filter's delay. */
static void the_lag_includes_the_filters_delay(void **state)
{
    (void)state;
    struct wb_sync sync;
    struct wb_sync_settings settings = both;
    settings.filter_delay = 0.05;
    const struct bench bench = {up_and_down, NULL, 5e-5, 1e-4, 0.05, 70.0};
    run(&bench, &settings, &sync);
    assert_close(sync.lag, LAG - 0.05, 3.0 * sync.uncertainty);
}

static void a_tap_gives_the_lag_of_a_ramp(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {only_up, tap_at_1_7, 5e-5, 1e-4, 0.0, 40.0};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_TAP);
    assert_close(sync.lag, LAG, 0.004);
    assert_close(sync.first_event, 1.7, 0.004);
    assert_true(sync.uncertainty < 0.012);
}

static void a_ramp_alone_gives_no_lag(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {only_up, NULL, 5e-5, 1e-4, 0.0, 40.0};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_NONE);
    assert_true(isnan(sync.lag));
    assert_non_null(strstr(sync.reason, "no reversal"));
}

static void equal_cycles_are_paired_in_order(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {three_cycles, NULL, 5e-5, 1e-4, 0.0, 125.0};
    run(&bench, &both, &sync);
    assert_int_equal(sync.method, WB_SYNC_REVERSAL);
    assert_int_equal(sync.n_events, 3);
    assert_close(sync.lag, LAG, 3.0 * sync.uncertainty + 0.01);
}

/* The force has two of three equal cycles: they can be paired in two ways. */
static void a_missing_cycle_gives_no_lag(void **state)
{
    (void)state;
    struct wb_sync sync;
    const struct bench bench = {three_cycles, NULL, 5e-5, 1e-4, 0.0, 125.0};
    run(&bench, &both, &sync);
    size_t n = 0, m = 0;
    while (motion_t[n] < 124.0)
        n++;
    while (force_t[m] < 43.0 - LAG)
        m++;
    const struct wb_signal motion = {motion_t, motion_x, n};
    const struct wb_signal shake = {motion_t, shake_x, n};
    const struct wb_signal force = {force_t + m, force_x + m, (size_t)(125.0 * 80.0) - m};
    wb_sync_find(&sync, &motion, &shake, &force, &both);
    assert_int_equal(sync.method, WB_SYNC_NONE);
    assert_non_null(strstr(sync.reason, "more than one way"));
}

int main(void)
{
    gsl_set_error_handler_off();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_reversal_gives_the_lag),
        cmocka_unit_test(a_reversal_after_a_rest_gives_the_lag),
        cmocka_unit_test(a_wire_that_relaxes_at_rest_gives_the_lag),
        cmocka_unit_test(a_stage_that_waits_before_turning_does_not_bias_the_lag),
        cmocka_unit_test(a_slow_reversal_gives_a_larger_uncertainty),
        cmocka_unit_test(the_lag_includes_the_filters_delay),
        cmocka_unit_test(a_tap_gives_the_lag_of_a_ramp),
        cmocka_unit_test(a_ramp_alone_gives_no_lag),
        cmocka_unit_test(equal_cycles_are_paired_in_order),
        cmocka_unit_test(a_missing_cycle_gives_no_lag),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
