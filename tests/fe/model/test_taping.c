/* Tape round a bundle: its angle from two equations, its layers from the geometry of a strip. */
#include "tests/check.h"

#include "fe/model/taping.h"

static const double C = 13.4e-3, t = 0.1e-3;

static struct wb_taping wind(double width, double lap, int hand)
{
    struct wb_taping taping;
    const struct wb_taping_helix helix = {width, lap, hand};
    assert_int_equal(wb_taping_wind(&taping, C, t, &helix), WB_OK);
    return taping;
}

/* The number of layers at x along the bundle and s along the outline (m, any). The middle of one
 * winding is at x = 0, s = 0; the windings go on beyond the ends of the bundle. A winding's edge
 * belongs to it where it begins and not where it ends: winding k covers p (k + h s / C) +- c / 2.
 */
static int layers_at(const struct wb_taping *taping, double x, double s)
{
    if (taping->kind == WB_TAPING_SLEEVE)
        return (int)taping->layers;
    const double at = x / taping->advance - taping->helix.hand * s / taping->circumference;
    const double begin = at - 0.5 * taping->layers, into = begin - floor(begin);
    const double whole = floor(taping->layers), part = taping->layers - whole;
    /* Whole layers do not depend on round-off at the edges. */
    return (int)whole + (into + part >= 1.0);
}

static void a_sleeve_has_its_layers_everywhere(void **state)
{
    (void)state;
    struct wb_taping taping;
    assert_int_equal(wb_taping_sleeve(&taping, C, t, 2), WB_OK);
    assert_int_equal(layers_at(&taping, 0.05, 0.3), 2);
    assert_close(wb_taping_thickness(&taping), 0.2e-3, 1e-18);
    assert_close(wb_taping_area(&taping), 2.0 * C, 1e-15);
}

static void advance_angle_and_lap_belong_together(void **state)
{
    (void)state;
    for (int i = 0; i < 10; i++) {
        const double lap = 0.07 * i;
        const struct wb_taping taping = wind(9e-3, lap, 1);
        assert_close(tan(taping.angle), taping.advance / C, 1e-12);
        assert_close(taping.covered * cos(taping.angle), 9e-3, 1e-15);
        assert_close(1.0 - taping.advance / taping.covered, lap, 1e-12);
        assert_close(taping.layers, taping.covered / taping.advance, 1e-12);
    }
}

/* Half-lapped, in the words of the paper: twice the thickness of each layer. */
static void half_lapped_there_are_two_layers_everywhere(void **state)
{
    (void)state;
    const struct wb_taping taping = wind(19e-3, 0.5, 1);
    assert_close(wb_taping_thickness(&taping), 0.2e-3, 1e-18);
    for (int i = 0; i < 200; i++) {
        for (int k = 0; k < 200; k++)
            assert_int_equal(layers_at(&taping, 0.114 * i / 199.0, C * k / 199.0), 2);
    }
}

/* Winding k rolled out is the strip round the line from (0, k p) to (C, (k + hand) p). */
static int layers_by_distance(const struct wb_taping *taping, double x, double s)
{
    const double p = taping->advance, run = hypot(C, p);
    int n = 0;
    for (int k = -60; k <= 60; k++) {
        const double off = ((x - k * p) * C - taping->helix.hand * s * p) / run;
        n += fabs(off) < 0.5 * taping->helix.width;
    }
    return n;
}

static void layers_are_those_of_strips_rolled_out(void **state)
{
    (void)state;
    static const double laps[] = {0.0, 0.2, 1.0 / 3.0, 0.5, 0.7};
    for (int i = 0; i < 5; i++) {
        for (int hand = -1; hand <= 1; hand += 2) {
            const struct wb_taping taping = wind(7e-3, laps[i], hand);
            double mean = 0.0;
            for (int k = 0; k < 4000; k++) {
                const double x = fmod(0.61803398875 * k, 1.0) * 10.0 * taping.advance;
                const double s = C * (k + 0.5) / 4000.0;
                const int layers = layers_at(&taping, x, s);
                assert_int_equal(layers, layers_by_distance(&taping, x, s));
                assert_int_equal(layers, layers_at(&taping, x, s + C));
                mean += layers / 4000.0;
            }
            assert_close(mean, taping.layers, 2e-3);
            assert_close(wb_taping_area(&taping), taping.layers * C, 1e-15);
        }
    }
}

static void hands_are_mirrored(void **state)
{
    (void)state;
    const struct wb_taping right = wind(7e-3, 0.3, 1), left = wind(7e-3, 0.3, -1);
    int differences = 0;
    for (int k = 0; k < 1000; k++) {
        const double x = 1e-5 * k, s = C * (k % 37 + 0.5) / 37.0;
        assert_int_equal(layers_at(&right, x, s), layers_at(&left, x, C - s));
        differences += layers_at(&right, x, s) != layers_at(&left, x, s);
    }
    assert_true(differences > 100);
}

static void what_cannot_be_wound_is_refused(void **state)
{
    (void)state;
    struct wb_taping taping;
    const struct wb_taping_helix wide = {2.01 * C, 0.5, 1}, just = {1.99 * C, 0.5, 1},
                                 none = {0.0, 0.5, 1}, all = {9e-3, 1.0, 1},
                                 no_hand = {9e-3, 0.5, 0};
    assert_int_equal(wb_taping_wind(&taping, C, t, &just), WB_OK);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_taping_wind(&taping, C, t, &wide), WB_ERR_ARGUMENT);
    assert_int_equal(wb_taping_wind(&taping, C, t, &none), WB_ERR_ARGUMENT);
    assert_int_equal(wb_taping_wind(&taping, C, t, &all), WB_ERR_ARGUMENT);
    assert_int_equal(wb_taping_wind(&taping, C, t, &no_hand), WB_ERR_ARGUMENT);
    assert_int_equal(wb_taping_wind(&taping, (double)NAN, t, &just), WB_ERR_ARGUMENT);
    assert_int_equal(wb_taping_sleeve(&taping, C, 0.0, 2), WB_ERR_ARGUMENT);
    assert_int_equal(wb_taping_sleeve(&taping, C, t, 0), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sleeve_has_its_layers_everywhere),
        cmocka_unit_test(advance_angle_and_lap_belong_together),
        cmocka_unit_test(half_lapped_there_are_two_layers_everywhere),
        cmocka_unit_test(layers_are_those_of_strips_rolled_out),
        cmocka_unit_test(hands_are_mirrored),
        cmocka_unit_test(what_cannot_be_wound_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
