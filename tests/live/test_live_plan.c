/* The predicted curve of a live view compared with the closed form, and a missing prediction. */
#include <math.h>
#include <string.h>

#include "base/units.h"
#include "live/live_plan.h"
#include "tests/check.h"

static struct wb_wire steel_wire(void)
{
    struct wb_wire wire = {
        .name = "steel",
        .conductor_diameter = 1.0 * WB_MM,
        .outer_diameter = 1.0 * WB_MM,
        .density = 7850.0,
        .has_properties = true,
        .material = {.youngs_modulus = 200e9,
                     .poissons_ratio = 0.3,
                     .yield_stress = 2e9,
                     .strength_coefficient = 1e9,
                     .hardening_exponent = 0.5,
                     .hardening = WB_HARDENING_ISOTROPIC_POWER},
    };
    wb_law_init_ludwik(&wire.law, &wire.material);
    return wire;
}

static const struct wb_specimen specimen = {.length = 0.1, .sample = 1, .n_markers = 2};

/* No strand, no weight. */
static struct wb_rig plain_rig(void)
{
    struct wb_rig rig = {.gravity = 0.0, .time_scale = 1.0};
    rig.load_cell.overload = 0.2;
    rig.stage.travel = 60.0 * WB_MM;
    return rig;
}

static void small_elastic_deflections_follow_3EI_over_L_cubed(void **state)
{
    (void)state;
    static struct wb_live_plan plan;
    const struct wb_wire wire = steel_wire();
    const struct wb_rig rig = plain_rig();
    assert_int_equal(wb_live_plan_make(&plan, &rig, &specimen, &wire, 1.0 * WB_MM), WB_OK);
    const double stiffness = 3.0 * 200e9 * wb_wire_second_moment(&wire) / pow(0.1, 3);
    double largest = 0.0;
    assert_true(plan.n_predicted > WB_LIVE_PLAN_STEPS);
    for (int i = 0; i < plan.n_predicted; i++) {
        assert_close(plan.tension[i], stiffness * plan.deflection[i], 1e-3 * stiffness * WB_MM);
        largest = fmax(largest, plan.deflection[i]);
    }
    assert_close(largest, 1.0 * WB_MM, 1e-9);
    assert_close(plan.force_limit, 0.2, 0.0);
    assert_close(plan.travel_limit, 60.0 * WB_MM, 0.0);
}

static void strand_carries_weight_and_counterweight(void **state)
{
    (void)state;
    static struct wb_live_plan plan;
    const struct wb_wire wire = steel_wire();
    struct wb_rig rig = plain_rig();
    rig.gravity = WB_STANDARD_GRAVITY;
    rig.strand.length = 0.76;
    rig.strand.counterweight = 2.7 * WB_G;
    assert_int_equal(wb_live_plan_make(&plan, &rig, &specimen, &wire, 1.0 * WB_MM), WB_OK);
    /* A straight wire at zero deflection: three eighths of its weight, and the counterweight. */
    const double weight = wb_wire_mass_per_length(&wire) * 0.1 * WB_STANDARD_GRAVITY;
    const double expected = 0.375 * weight + 2.7 * WB_G * WB_STANDARD_GRAVITY;
    assert_close(plan.deflection[0], 0.0, 1e-9);
    assert_close(plan.tension[0], expected, 0.01 * expected);
}

static void wire_without_properties_has_no_prediction(void **state)
{
    (void)state;
    static struct wb_live_plan plan;
    struct wb_wire wire = steel_wire();
    const struct wb_rig rig = plain_rig();
    wire.has_properties = false;
    assert_int_equal(wb_live_plan_make(&plan, &rig, &specimen, &wire, 1.0 * WB_MM), WB_OK);
    assert_int_equal(plan.n_predicted, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_elastic_deflections_follow_3EI_over_L_cubed),
        cmocka_unit_test(strand_carries_weight_and_counterweight),
        cmocka_unit_test(wire_without_properties_has_no_prediction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
