/* Bonds that break. */
#include "fe/swept/swept_private.h"

#include "tests/fe/swept/taped_block.h"

/* Opens by `n` and slides by `s` m in `steps` steps, and returns the work. */
static double work_of(struct pair *p, double n, double s, int steps, double *dissipated)
{
    double work = 0.0, before[3] = {0.0}, sum[3];
    *dissipated = 0.0;
    for (int step = 1; step <= steps; step++) {
        const double part = (double)step / steps;
        set_tape(p, 0.6 * s * part, n * part, 0.8 * s * part);
        *dissipated += pair_forces(p).dissipated;
        sum_tape(p, sum);
        work -= (0.5 * (sum[0] + before[0]) * 0.6 * s + 0.5 * (sum[1] + before[1]) * n +
                 0.5 * (sum[2] + before[2]) * 0.8 * s) /
                steps;
        memcpy(before, sum, sizeof sum);
    }
    return work;
}

static void area_below_the_curve_is_the_fracture_energy(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    /* Bilinear curves: final opening 2 G / strength = 100 um, final slip 250 um. */
    const double way[3][2] = {{110e-6, 0.0}, {0.0, 260e-6}, {80e-6, 200e-6}};
    for (int is_double = 0; is_double < 2; is_double++) {
        for (int mode = 0; mode < 3; mode++) {
            struct pair p = pair_create(&settings, is_double, WB_SWEPT_BEST);
            double dissipated = 0.0;
            const double work = work_of(&p, way[mode][0], way[mode][1], 4000, &dissipated);
            const double expected = 25.0 * whole_area;
            assert_close_relative(work, expected, 1e-4);
            assert_close_relative(dissipated, expected, is_double ? 1e-9 : 1e-4);
            assert_close(wb_swept_cohesion_damage(p.cohesion, 2, 7), 1.0, 0.0);
            const struct wb_swept_cohesion_sums sums = pair_forces(&p);
            assert_true(sums.stored == 0.0 && sums.dissipated == 0.0);
            pair_destroy(&p);
        }
    }
}

static void traction_peaks_at_the_strength(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    for (int mode = 0; mode < 2; mode++) {
        struct pair p = pair_create(&settings, true, WB_SWEPT_BEST);
        double largest = 0.0, at = 0.0, sum[3];
        for (int step = 1; step <= 1000; step++) {
            const double opened = 0.1e-6 * step;
            set_tape(&p, mode ? opened : 0.0, mode ? 0.0 : opened, 0.0);
            (void)pair_forces(&p);
            sum_tape(&p, sum);
            const double traction = -sum[mode ? 0 : 1] / whole_area;
            if (traction > largest) {
                largest = traction;
                at = opened;
            }
        }
        const double strength = mode ? 0.2e6 : 0.5e6, stiffness = mode ? 10e9 : 30e9;
        assert_close_relative(largest, strength, 0.01);
        assert_close(at, strength / stiffness, 0.1e-6);
        pair_destroy(&p);
    }
}

static void unloading_goes_back_to_the_origin(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    struct pair p = pair_create(&settings, true, WB_SWEPT_BEST);
    double sum[3], again[3];
    set_tape(&p, 0.0, 50e-6, 0.0);
    const struct wb_swept_cohesion_sums first = pair_forces(&p);
    sum_tape(&p, sum);
    /* Half of the softening branch: G (l - 1) / (l_f - 1) of a bilinear curve, in one step. */
    const double onset = 0.5e6 / 30e9, end = 100e-6;
    assert_close_relative(-sum[1] / whole_area, 0.5e6 * (end - 50e-6) / (end - onset), 1e-9);
    assert_close_relative(first.dissipated, 25.0 * whole_area * (50e-6 - onset) / (end - onset),
                          1e-9);
    set_tape(&p, 0.0, 25e-6, 0.0);
    assert_true(pair_forces(&p).dissipated == 0.0);
    sum_tape(&p, again);
    assert_close_relative(again[1], 0.5 * sum[1], 1e-12);
    /* In compression the stiffness is undamaged. */
    set_tape(&p, 0.0, -2e-6, 0.0);
    (void)pair_forces(&p);
    sum_tape(&p, again);
    assert_close_relative(again[1], 30e9 * 2e-6 * whole_area, 1e-9);
    /* Virgin again. */
    size_t bytes;
    void *const damage = wb_swept_cohesion_data(p.cohesion, &bytes);
    memset(damage, 0, bytes);
    set_tape(&p, 0.0, 10e-6, 0.0);
    (void)pair_forces(&p);
    sum_tape(&p, again);
    assert_close_relative(again[1], -30e9 * 10e-6 * whole_area, 1e-9);
    pair_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(area_below_the_curve_is_the_fracture_energy),
        cmocka_unit_test(traction_peaks_at_the_strength),
        cmocka_unit_test(unloading_goes_back_to_the_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
