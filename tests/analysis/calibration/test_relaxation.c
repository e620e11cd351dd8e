/* Wires that relax: the tension falls while the tip is held at the turn, and the calibration fits
 * Maxwell elements in addition to its law.
 *
 * The truth is the virtual rig's core in a jacket of which a part is a Maxwell element in each
 * fibre (fixtures/virtual/composite.h), scaled until the tension falls by the required share.
 */
#include <gsl/gsl_errno.h>

#include "analysis/calibration/cycle/cycle_check.h"
#include "base/units.h"
#include "tests/analysis/fast_rig.h"
#include "tests/check.h"

enum {
    SPECIMENS = 3
};

/* Modulus of the jacket relative to the default, and fall of the tension in a dwell of a minute, as
 * part of the largest force. */
static const struct wire {
    double jacket, fall;
    int elements;
} wires[] = {{0.5, 0.01, 1}, {3.0, 0.05, 1}, {6.0, 0.10, 1}};

struct found {
    struct wb_cycle_calibration c;
    struct wb_cycle_remarks remarks;
    double fall; /* of the tension in the dwell, over the largest force */
    double moment[WB_CYCLE_MOMENTS], residual_curvature_ratio, unloading; /* true */
};

/* Specimens of one wire, which differ only in bow, markers and noise. */
static void calibrate(struct found *found, double jacket, double dwell, uint64_t seed)
{
    struct wb_dataset datasets[SPECIMENS] = {{.rows = NULL}};
    const struct wb_dataset *list[SPECIMENS];
    struct wb_cycle_calibrate_settings settings;
    struct wb_reason why = {.text = ""};
    const double change = 1.0;
    double residual;
    struct fast_rig wire;
    fast_rig_init(&wire, 1, 85.0 * WB_MM, seed);
    wire.variant = WB_COMPOSITE_RELAXING;
    wire.composite.jacket_modulus *= jacket;
    wire.dwell = dwell;
    for (int i = 0; i < SPECIMENS; i++) {
        wb_truth_draw(&wire.truth, seed * SPECIMENS + (uint64_t)i, &wire.rig, &wire.specimen);
        wire.truth.stiffness_factor = wire.truth.yield_factor = 1.0;
        assert_int_equal(fast_rig_run(&wire, &datasets[i]), WB_OK);
        datasets[i].info.sample = i + 1;
        list[i] = &datasets[i];
    }
    wb_cycle_calibrate_default_settings(&settings);
    if (wb_cycle_check_calibrate(&found->c, &found->remarks, list, SPECIMENS, &settings, &why) !=
        WB_OK)
        fail_msg("%s", why.text);
    const struct wb_cycle_calibration *const c = &found->c;
    const struct wb_cycle_data *const data = &c->members[0].data;
    if (data->n_held > 0)
        found->fall =
            (data->held[0].tension - data->held[data->n_held - 1].tension) / data->max_force;
    fast_rig_truth(&wire, WB_CYCLE_MOMENTS, c->curvature, found->moment, NULL, &residual);
    found->residual_curvature_ratio = residual / c->largest_curvature;
    fast_rig_unloading(&wire, c->largest_curvature, 1, &change, &found->unloading);
    for (int i = 0; i < SPECIMENS; i++)
        wb_dataset_release(&datasets[i]);
}

static void show(const struct found *f)
{
    const struct wb_cycle_calibration *const c = &f->c;
    printf("force falls by %.2f %% in the dwell; %s, misfit %.3f %%", 100.0 * f->fall,
           wb_candidate_name(c->chosen), 100.0 * c->ranked[0].misfit);
    for (int k = 0; k < c->law.n_maxwell; k++)
        printf("; element of %.3f E, %.1f s",
               c->law.maxwell[k].modulus / c->law.material.youngs_modulus, c->law.maxwell[k].time);
    printf("\n  M off by");
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        printf(" %+.2f", 100.0 * (c->moment[k].value / f->moment[k] - 1.0));
    printf(" %%, unloading stiffness by %+.2f %%, residual curvature ratio by %+.4f of %.4f; %.1f "
           "s of CPU\n",
           100.0 * (wb_cycle_stiffness_at(&c->unloading, 1.0)->value / f->unloading - 1.0),
           c->residual_curvature_ratio.value - f->residual_curvature_ratio,
           f->residual_curvature_ratio, c->cpu_s);
}

static void moments_of_a_relaxing_wire_are_within_two_percent(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < WB_COUNT(wires); i++) {
        struct found found = {.fall = 0.0};
        int notes = 0;
        calibrate(&found, wires[i].jacket, 60.0, 900 + i);
        show(&found);
        assert_close_relative(found.fall, wires[i].fall, 0.25);
        assert_int_equal(found.c.law.n_maxwell, wires[i].elements);
        assert_close_relative(found.c.law.maxwell[0].time, 15.0, 0.2);
        for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
            assert_close_relative(found.c.moment[k].value, found.moment[k], 0.02);
        for (int k = 0; k < found.remarks.n; k++) {
            assert_int_equal(found.remarks.items[k].severity, WB_CHECK_NOTE);
            notes += strstr(found.remarks.items[k].text, "relaxes") != NULL;
        }
        assert_int_equal(notes, SPECIMENS);
        wb_cycle_calibrate_release(&found.c);
    }
}

/* A dwell of two seconds determines the rate of relaxation, but not its time constant as well. */
static void a_short_dwell_shows_relaxation(void **unused)
{
    (void)unused;
    struct found found = {.fall = 0.0};
    calibrate(&found, 3.0, 2.0, 950);
    show(&found);
    assert_int_equal(found.c.law.n_maxwell, 1);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        assert_close_relative(found.c.moment[k].value, found.moment[k], 0.02);
    wb_cycle_calibrate_release(&found.c);
}

/* Without a dwell the law includes the relaxation, and the intervals allow for it. */
static void intervals_of_a_test_without_a_dwell_allow_for_relaxation(void **unused)
{
    (void)unused;
    struct found found = {.fall = 0.0};
    calibrate(&found, 1.0, 0.2, 960);
    show(&found);
    const struct wb_cycle_calibration *const c = &found.c;
    assert_int_equal(c->law.n_maxwell, 0);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        const double u =
            c->budget[WB_CYCLE_FIRST_MOMENT + k].uncertainty[WB_FROM_SHARED + WB_SHARED_RELAXATION];
        assert_true(u > 0.0 && u < 0.05);
        assert_true(c->moment[k].low <= found.moment[k] && found.moment[k] <= c->moment[k].high);
    }
    assert_true(
        c->budget[WB_CYCLE_RESIDUAL_CURVATURE].uncertainty[WB_FROM_SHARED + WB_SHARED_RELAXATION] >
        0.01);
    assert_true(c->residual_curvature_ratio.low <= found.residual_curvature_ratio &&
                found.residual_curvature_ratio <= c->residual_curvature_ratio.high);
    wb_cycle_calibrate_release(&found.c);
}

/* A wire without relaxation gets no element, whatever the dwell. */
static void a_wire_that_does_not_relax_gets_no_element(void **unused)
{
    (void)unused;
    struct found found = {.fall = 0.0};
    calibrate(&found, 0.01, 20.0, 970);
    show(&found);
    assert_int_equal(found.c.law.n_maxwell, 0);
    assert_true(isnan(
        found.c.budget[WB_CYCLE_FIRST_MOMENT].uncertainty[WB_FROM_SHARED + WB_SHARED_RELAXATION]));
    wb_cycle_calibrate_release(&found.c);
}

int main(void)
{
    gsl_set_error_handler_off();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moments_of_a_relaxing_wire_are_within_two_percent),
        cmocka_unit_test(a_short_dwell_shows_relaxation),
        cmocka_unit_test(intervals_of_a_test_without_a_dwell_allow_for_relaxation),
        cmocka_unit_test(a_wire_that_does_not_relax_gets_no_element),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
