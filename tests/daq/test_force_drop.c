/* A drop of the force during loading, with synthetic readings. */
#include "daq/test/force_drop.h"

#include <math.h>
#include <string.h>

#include "base/units.h"
#include "tests/check.h"

static double noise(uint32_t *random)
{
    double sum = 0.0;
    for (int i = 0; i < 12; i++) {
        *random = *random * 1664525u + 1013904223u;
        sum += (double)(*random >> 8) / (1 << 24);
    }
    return sum - 6.0;
}

/* 53 mm at 1 mm/s and 80 readings/s: a softening spring of 1 N/m; from `at` mm on the force is
 * multiplied by `left`. Returns the position of the report, mm; NaN: none. */
static double bend(double at, double left, double share, char text[WB_START_CHECK_TEXT])
{
    struct wb_force_drop drop = {.noise = 1e-4, .share = share};
    uint32_t random = 99;
    for (int k = 0; k < 53 * 80; k++) {
        const double travel = k / 80.0, force = 40e-3 * (1.0 - exp(-travel / 30.0));
        if (wb_force_drop_add(&drop, (travel >= at ? left : 1.0) * force + 1e-4 * noise(&random),
                              text))
            return travel;
    }
    return (double)NAN;
}

static void break_and_slip_are_reported_at_once(void **state)
{
    (void)state;
    char text[WB_START_CHECK_TEXT];
    for (double at = 10.0; at < 50.0; at += 5.0) {
        assert_close(bend(at, 0.0, 0.1, text), at + 0.03, 0.05);
        assert_close(bend(at, 0.8, 0.1, text), at + 0.03, 0.05);
        assert_non_null(strstr(text, "broke, or the wire slips"));
    }
}

static void noise_and_rising_force_are_not_reported(void **state)
{
    (void)state;
    char text[WB_START_CHECK_TEXT];
    assert_true(isnan(bend(1e9, 1.0, 0.1, text)));
    assert_true(isnan(bend(20.0, 0.93, 0.1, text)));
    /* A force close to the noise is not judged. */
    assert_true(isnan(bend(0.5, 0.0, 0.1, text)));
}

static void share_of_zero_disables_the_watch(void **state)
{
    (void)state;
    char text[WB_START_CHECK_TEXT];
    assert_true(isnan(bend(20.0, 0.0, 0.0, text)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(break_and_slip_are_reported_at_once),
        cmocka_unit_test(noise_and_rising_force_are_not_reported),
        cmocka_unit_test(share_of_zero_disables_the_watch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
