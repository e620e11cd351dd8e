/* The layers of a real cable at equal curvature, by the campaign of its report. Needs
 * WIREBENCH_REAL_DATA; skipped (exit status 77) without.
 *
 * The ranges are from an independent evaluation of the same files: measured moment relative to that
 * of sliding wires 1.6 to 1.8 for group 4, 2.1 to 2.5 for 5b, 7 to 11 for 7; 5b relative to 4 1.24
 * to 1.44. Group 4 is compared up to 4 mm, from the deflection at which seating has no influence;
 * the others up to the end of their curves. */
#include <stdlib.h>

#include "analysis/report/machines/machines_kind.h"
#include "base/file.h"
#include "tests/check.h"

#define SKIPPED 77

static struct wb_machines campaign;
static struct wb_machines_results results;

static int load(void **state)
{
    char path[WB_PATH];
    (void)state;
    assert_int_equal(wb_file_find_fixture(path, "campaigns", "real-cable", NULL), WB_OK);
    assert_int_equal(wb_kind_read(&wb_machines_kind, &campaign, path), WB_OK);
    campaign.calibrates = false; /* minutes, and not what is looked at here */
    assert_int_equal(wb_machines_results_load(&results, &campaign), WB_OK);
    assert_int_equal(wb_machines_results_compute(&results, 1, NULL, NULL), WB_OK);
    assert_int_equal(results.outcome.n_usable, 23);
    assert_int_equal(results.cable.n_layers, 3);
    return 0;
}

static int release(void **state)
{
    (void)state;
    wb_machines_results_release(&results);
    wb_machines_release(&campaign);
    return 0;
}

/* Range of a number over the curvatures at which seating has no influence. */
enum number {
    RATIO,
    CHI,
    OVER_FIRST
};
static void range_of(int layer, enum number number, double from, double to, double *low,
                     double *high)
{
    const struct wb_machines_layer *const l = &results.cable.layers[layer];
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int k = 0; k < WB_MACHINES_PLACES; k++) {
        const double value = number == RATIO ? l->place[k].ratio.value
                             : number == CHI ? l->place[k].chi.value
                                             : l->over_first[k];
        if (l->is_seating[k] || l->curvature[k] < from || l->curvature[k] > to)
            continue;
        *low = fmin(*low, value);
        *high = fmax(*high, value);
        assert_true(isfinite(value));
    }
    assert_true(*low <= *high);
    printf("layer %d: %.3f to %.3f\n", layer, *low, *high);
}

static void ratios_to_moments_of_sliding_wires_are_the_listed_ones(void **state)
{
    (void)state;
    double low, high;
    range_of(0, RATIO, 0.0, 64.0, &low, &high);
    assert_close(low, 1.6, 0.06);
    assert_close(high, 1.8, 0.06);
    range_of(1, RATIO, 0.0, 15.0, &low, &high);
    assert_close(low, 2.15, 0.1);
    assert_close(high, 2.5, 0.1);
    range_of(2, RATIO, 0.0, 18.0, &low, &high);
    assert_true(low > 7.0 && high < 11.5);
}

static void insulation_makes_the_wires_stiffer_by_a_quarter_to_a_half(void **state)
{
    (void)state;
    double low, high;
    range_of(1, OVER_FIRST, 0.0, 15.0, &low, &high);
    assert_true(low > 1.24 && high < 1.45);
}

/* The six wires are close to sliding; the layers around them increase the moment. */
static void bare_wires_slide_almost_freely_and_the_cable_does_not(void **state)
{
    (void)state;
    double low, high;
    range_of(0, CHI, 0.0, 80.0, &low, &high);
    assert_true(low > 0.02 && high < 0.11);
    range_of(1, CHI, 0.0, 15.0, &low, &high);
    assert_true(low > 0.04 && high < 0.13);
    range_of(2, CHI, 0.0, 20.0, &low, &high);
    assert_true(low > 0.35 && high < 0.85);
}

/* Two series whose wires differ by a quarter: one degree of freedom, so that the moment of sliding
 * wires is hardly known, and yet chi, whose scale is the bonded moment, is. */
static void intervals_contain_the_two_series(void **state)
{
    (void)state;
    const struct wb_machines_layer *const layer = &results.cable.layers[0];
    for (int k = 0; k < WB_MACHINES_PLACES; k++) {
        const struct wb_cable_place *const place = &layer->place[k];
        assert_true(place->ratio.high > 2.0 * place->ratio.low);
        for (int s = 0; s < 2; s++) {
            assert_true(layer->chi_of_series[s][k] > place->chi.low);
            assert_true(layer->chi_of_series[s][k] < place->chi.high);
        }
    }
}

int main(void)
{
    if (!getenv("WIREBENCH_REAL_DATA")) {
        printf("skipped: WIREBENCH_REAL_DATA is not set\n");
        return SKIPPED;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ratios_to_moments_of_sliding_wires_are_the_listed_ones),
        cmocka_unit_test(insulation_makes_the_wires_stiffer_by_a_quarter_to_a_half),
        cmocka_unit_test(bare_wires_slide_almost_freely_and_the_cable_does_not),
        cmocka_unit_test(intervals_contain_the_two_series),
    };
    return cmocka_run_group_tests(tests, load, release);
}
