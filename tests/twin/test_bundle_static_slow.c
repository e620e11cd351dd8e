/* The static and the explicit bundle: two formulations of one model. */
#include "tests/fe/bundle/bundles.h"
#include "tests/twin/bundle_static.h"

/* Seven wires with their tape to 53 mm. Friction of 0.1, as wires roll in the explicit
 * model only. */
static void static_and_explicit_curves_agree_within_five_percent(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_settings settings = {.open_stiffness = 1e-4};
    struct wb_bundle_static *bundle = NULL;
    double worst = 0.0;

    read_model(SEVEN "run: {selective_mass_scaling: 100, deflection_mm: 53, rows: 53, "
                     "duration_s: 2}\nloads: {weight: false}\n");
    model.interface.friction_static = model.interface.friction_kinetic = 0.1;
    run_model(NULL);
    assert_true(result.converged && !result.exceeded);
    assert_int_equal(wb_bundle_static_create(&bundle, &model, &settings), WB_OK);
    for (int i = 2; i <= 53; i++) {
        const struct wb_bundle_row *row = &result.rows[i];
        struct wb_bundle_static_point point;
        assert_int_equal(wb_bundle_static_move(bundle, row->deflection, &point), WB_OK);
        assert_int_equal(point.end, WB_BUNDLE_STATIC_CONVERGED);
        const double error = row->force / point.vertical - 1.0;
        if (i % 10 == 0 || i == 2 || i == 53)
            print_message("%4.1f mm: static %.4f N, explicit %.4f N, %+.1f %%\n",
                          row->deflection * 1e3, point.vertical, row->force, 100.0 * error);
        worst = fmax(worst, fabs(error));
        assert_close(row->tip[0], point.tip_x, 0.5e-3);
    }
    wb_bundle_static_destroy(bundle);
    assert_true(worst < 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(static_and_explicit_curves_agree_within_five_percent, release),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
