/* The first force of a test, with synthetic readings. */
#include "daq/test/first_force.h"

#include <string.h>

#include "tests/check.h"

static const struct wb_rig rig = {
    .load_cell = {.capacity = 0.2, .filter_delay = 0.05, .noise = 1e-4},
    .stage = {.speed = 1e-3},
};
static const struct wb_first_force_bounds bounds = {0.5, 5.0, "the wire"};

/* A strand that is slack for 2 mm of travel, then a spring of `stiffness` (N/m) behind the cell's
 * filter; 80 readings/s to 10 mm. Returns where (m of deflection) the verdict came. */
static double follow(double stiffness, double noise, const struct wb_first_force_bounds *by,
                     enum wb_first_force_verdict *verdict, char text[WB_START_CHECK_TEXT])
{
    struct wb_first_force force;
    wb_first_force_begin(&force, noise, &rig);
    double filtered = 0.0, deflection = 0.0;
    *verdict = WB_FIRST_FORCE_OPEN;
    for (int k = 0; k < 1000 && *verdict == WB_FIRST_FORCE_OPEN; k++) {
        const double t = k / 80.0, travel = rig.stage.speed * t;
        deflection = travel > 2e-3 ? travel - 2e-3 : 0.0;
        filtered += (stiffness * deflection - filtered) / 80.0 / rig.load_cell.filter_delay;
        *verdict =
            wb_first_force_add(&force, deflection, filtered + (k % 2 ? noise : -noise), by, text);
    }
    if (*verdict == WB_FIRST_FORCE_AGREES)
        assert_close(wb_first_force_slope(&force), stiffness, 0.02 * stiffness);
    return deflection;
}

static void plausible_force_agrees(void **state)
{
    (void)state;
    char text[WB_START_CHECK_TEXT];
    enum wb_first_force_verdict verdict;
    for (int i = 0; i < 9; i++) {
        const double stiffness = 0.55 + i * 0.55;
        const double at = follow(stiffness, 5e-5, &bounds, &verdict, text);
        assert_int_equal(verdict, WB_FIRST_FORCE_AGREES);
        assert_true(at < 4e-3);
    }
}

static void each_wrong_force_is_reported_with_its_remedy(void **state)
{
    (void)state;
    static const struct {
        double stiffness;
        const char *word;
    } faults[] = {{-2.0, "load_cell.sign"}, {-2000.0, "load_cell.sign"}, {0.4, "at least 0.5 by"},
                  {6.0, "at most 5 by"},    {2000.0, "load_cell.scale"}, {0.0, "shows no force"}};
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        char text[WB_START_CHECK_TEXT] = "";
        enum wb_first_force_verdict verdict;
        const double at = follow(faults[i].stiffness, 1e-5, &bounds, &verdict, text);
        assert_int_equal(verdict, WB_FIRST_FORCE_WRONG);
        if (!strstr(text, faults[i].word))
            fail_msg("%g N/m: '%s'", faults[i].stiffness, text);
        assert_true(at < 5e-3);
    }
}

static void without_bounds_only_the_sign_is_judged(void **state)
{
    (void)state;
    static const struct wb_first_force_bounds none;
    char text[WB_START_CHECK_TEXT];
    enum wb_first_force_verdict verdict;
    follow(2000.0, 1e-5, &none, &verdict, text);
    assert_int_equal(verdict, WB_FIRST_FORCE_AGREES);
    follow(-0.5, 1e-5, &none, &verdict, text);
    assert_int_equal(verdict, WB_FIRST_FORCE_WRONG);
}

/* At the lower bound the force exceeds the noise late, which must not stop the test. */
static void soft_wire_under_noise_is_waited_for(void **state)
{
    (void)state;
    static const struct wb_first_force_bounds soft = {0.05, 5.0, "the wire"};
    char text[WB_START_CHECK_TEXT];
    enum wb_first_force_verdict verdict;
    const double at = follow(0.15, 1e-4, &soft, &verdict, text);
    assert_int_equal(verdict, WB_FIRST_FORCE_AGREES);
    assert_true(at > 4e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plausible_force_agrees),
        cmocka_unit_test(each_wrong_force_is_reported_with_its_remedy),
        cmocka_unit_test(without_bounds_only_the_sign_is_judged),
        cmocka_unit_test(soft_wire_under_noise_is_waited_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
