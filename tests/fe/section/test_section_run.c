/* A complete test in the section model: rows, phases, rigidities. */
#include "fe/section/section_run.h"

#include "tests/fe/section/section_fixture.h"

static struct wb_section_run run;

static int release(void **unused)
{
    (void)unused;
    wb_section_run_release(&run);
    return 0;
}

static void compute(bool (*stop)(void *context), void *context)
{
    assert_int_equal(wb_section_run_init(&run, &model, 11), WB_OK);
    const struct wb_section_run_settings settings = {.stop = stop, .context = context};
    assert_int_equal(wb_section_run(&run, &model, &settings), WB_OK);
}

static void cycles_have_rows_up_and_down_and_a_strand_goes_slack(void **unused)
{
    (void)unused;
    read_bundle("7-type3");
    model.loads = (struct wb_bundle_loads){.strand_length = 0.76, .weight = true};
    model.run.rows = 20;
    model.run.cycles = 2;
    compute(NULL, NULL);
    assert_true(run.converged && !run.stopped);
    assert_int_equal(run.n_rows, 81);
    assert_close(run.rows[0].force, 0.0, 0.0);
    assert_true(run.zero_force > 0.02);
    for (int i = 0; i < 81; i++) {
        const struct wb_section_run_row *const row = &run.rows[i];
        const int way = i > 0 ? (i - 1) / 20 : 0;
        assert_int_equal(row->cycle, way / 2 + 1);
        if (row->phase == WB_PHASE_SLACK)
            assert_close(row->point.tension, 0.0, 1e-12);
        else
            assert_int_equal(row->phase, way % 2 ? WB_PHASE_UNLOAD : WB_PHASE_LOAD);
        /* The last position of the shape is the tip. */
        assert_close(run.shape[i * 11 + 10][1], row->point.deflection, 1e-12);
        assert_close(run.shape[i * 11 + 10][0], row->point.tip_x, 1e-12);
    }
    assert_int_equal(run.rows[21].phase, WB_PHASE_UNLOAD);
    assert_int_equal(run.rows[40].phase, WB_PHASE_SLACK);
    assert_int_equal(run.rows[41].phase, WB_PHASE_SLACK);
    assert_close(run.rows[20].point.deflection, 53e-3, 1e-9);
    assert_close(run.rows[60].point.deflection, 53e-3, 1e-9);
    /* The second loading returns approximately to the end of the first one. */
    assert_close_relative(run.rows[60].force, run.rows[20].force, 0.03);
    assert_true(run.imbalance < 2e-3);
}

static bool after_four(void *context)
{
    int *const n = context;
    return (*n)++ == 4;
}

static void a_run_that_is_stopped_keeps_its_rows(void **unused)
{
    (void)unused;
    int asked = 0;
    read_bundle("7-type3");
    compute(after_four, &asked);
    assert_true(run.stopped);
    assert_int_equal(run.n_rows, 4);
}

/* alpha is a property of the section, for any length, with a free and a capped tip. */
static void rigidities_of_three_lengths_have_one_alpha(void **unused)
{
    (void)unused;
    static const char *const bundles[] = {"7-type3", "7-type3-capped"};

    for (int i = 0; i < 2; i++) {
        read_bundle(bundles[i]);
        model.run.rows = 10;
        compute(NULL, NULL);
        const struct wb_bundle_rigidity limit = wb_bundle_model_rigidity(&model);
        const double alpha = run.rigidity[1].alpha / run.rigidity[1].length;
        for (int k = 0; k < 3; k++) {
            const struct wb_section_run_rigidity *const r = &run.rigidity[k];
            print_message("%s, %g mm: E I %g N mm2, alpha L %g\n", bundles[i], r->length * 1e3,
                          r->rigidity * 1e6, r->alpha);
            assert_close(r->length, 0.114 * pow(2.0, k - 1), 1e-12);
            assert_true(r->rigidity > limit.sliding[0] && r->rigidity < limit.bonded[0]);
            assert_close_relative(r->alpha / r->length, alpha, 0.04);
        }
        wb_section_run_release(&run);
    }
}

static void a_bundle_without_tape_has_the_rigidity_of_its_wires_and_no_alpha(void **unused)
{
    (void)unused;
    read_bundle("7-type3");
    model.has_tape = false;
    compute(NULL, NULL);
    for (int k = 0; k < 3; k++) {
        assert_close_relative(run.rigidity[k].rigidity, wb_bundle_model_rigidity(&model).wires,
                              2e-3);
        assert_true(isnan(run.rigidity[k].alpha));
    }
    assert_int_equal(run.n_curve, 18);
}

/* With strand and weight the curve is computed by a loading of its own. */
static void the_homogenised_curve_does_not_depend_on_how_the_test_is_loaded(void **unused)
{
    (void)unused;
    struct wb_section_homogenise_point by_force[18];
    read_bundle("7-type3");
    compute(NULL, NULL);
    assert_int_equal(run.n_curve, 18);
    memcpy(by_force, run.curve, sizeof by_force);
    wb_section_run_release(&run);
    model.loads = (struct wb_bundle_loads){.strand_length = 0.76, .weight = true};
    model.run.cycles = 1;
    compute(NULL, NULL);
    assert_int_equal(run.n_curve, 18);
    for (int i = 0; i < 18; i++) {
        assert_close_relative(run.curve[i].moment, by_force[i].moment, 1e-5);
        assert_close_relative(run.curve[i].curvature, by_force[i].curvature, 1e-3);
    }
}

/* In neither unloading is the force zero at a row. */
static void a_run_until_free_ends_there_and_reports_springback(void **unused)
{
    (void)unused;
    static const struct wb_section_run_settings settings = {.until_free = true,
                                                            .no_rigidities = true};
    double springback[2], ratio[2];
    for (int i = 0; i < 2; i++) {
        read_bundle("7-type3");
        model.run.rows = i == 0 ? 23 : 101;
        model.run.cycles = 1;
        assert_int_equal(wb_section_run_init(&run, &model, 2), WB_OK);
        assert_int_equal(wb_section_run(&run, &model, &settings), WB_OK);
        assert_true(run.converged && !run.stopped);
        assert_true(run.n_rows > model.run.rows + 1 && run.n_rows < 2 * model.run.rows);
        assert_true(run.rows[run.n_rows - 2].force > 0.0);
        assert_true(run.rows[run.n_rows - 1].force <= 0.0);
        assert_close(run.rigidity[0].length, 0.0, 0.0);
        assert_int_equal(run.n_curve, i == 0 ? 12 : 17);
        springback[i] = wb_section_run_springback(&run);
        ratio[i] = wb_section_run_residual_curvature(&run);
        wb_section_run_release(&run);
    }
    print_message("springback %.4f, residual curvature ratio %.4f with 23 rows, %.4f and %.4f with "
                  "101\n",
                  springback[0], ratio[0], springback[1], ratio[1]);
    assert_close(ratio[0], ratio[1], 5e-3);
    /* The clamp has yielded most: more of its curvature remains than of the deflection. */
    assert_true(ratio[1] > 1.0 - springback[1] && ratio[1] < 1.0);
    assert_close(springback[0], springback[1], 2e-3);
    assert_close(springback[1], 1.0 - 28.39 / 53.0, 3e-3);
    read_bundle("7-type3");
    compute(NULL, NULL);
    assert_true(isnan(wb_section_run_springback(&run)));
    assert_true(isnan(wb_section_run_residual_curvature(&run)));
}

static void friction_that_decays_becomes_the_geometric_mean(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        read_bundle("7-type3");
        model.run.rows = 1;
        model.run.deflection = 1e-3;
        if (i == 1)
            model.interface.friction.mu_kinetic = 0.4;
        compute(NULL, NULL);
        assert_close(run.friction, i == 0 ? 0.2 : 0.4, 1e-12);
        assert_int_equal(run.is_mean, i == 0);
        wb_section_run_release(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(cycles_have_rows_up_and_down_and_a_strand_goes_slack, release),
        cmocka_unit_test_teardown(a_run_that_is_stopped_keeps_its_rows, release),
        cmocka_unit_test_teardown(rigidities_of_three_lengths_have_one_alpha, release),
        cmocka_unit_test_teardown(a_bundle_without_tape_has_the_rigidity_of_its_wires_and_no_alpha,
                                  release),
        cmocka_unit_test_teardown(the_homogenised_curve_does_not_depend_on_how_the_test_is_loaded,
                                  release),
        cmocka_unit_test_teardown(a_run_until_free_ends_there_and_reports_springback, release),
        cmocka_unit_test(friction_that_decays_becomes_the_geometric_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
