/* The section model outside the range of the paper's bundles: cycles of other packings, long and
 * short bundles, thin tape, low friction, and states without equilibrium. */
#include "fe/section/section_run.h"

#include "base/units.h"
#include "tests/fe/section/section_fixture.h"

static struct wb_section_run run;

static int release(void **unused)
{
    (void)unused;
    wb_section_run_release(&run);
    return 0;
}

static void compute(void)
{
    const struct wb_section_run_settings settings = {.no_rigidities = true};
    wb_section_run_release(&run);
    assert_int_equal(wb_section_run_init(&run, &model, 2), WB_OK);
    assert_int_equal(wb_section_run(&run, &model, &settings), WB_OK);
}

/* Reads a bundle, without weight, for one loading to its largest deflection. */
static void begin(const char *name, int rows)
{
    read_bundle(name);
    model.run.rows = rows;
    model.run.cycles = 0;
}

static double last_force(void)
{
    compute();
    assert_true(run.converged);
    return run.rows[run.n_rows - 1].force;
}

static void cycles_of_other_packings_repeat_and_balance_energy(void **unused)
{
    (void)unused;
    static const char *const names[] = {"7-type3-turned",  "7-type3-capped", "12-type3-circle",
                                        "19-type3-circle", "19-type3",       "27-type3"};
    enum {
        ROWS = 12
    };

    for (size_t b = 0; b < sizeof names / sizeof names[0]; b++) {
        double friction = 0.0;
        begin(names[b], ROWS);
        model.loads = (struct wb_bundle_loads){.strand_length = 0.76, .weight = true};
        model.run.cycles = 2;
        compute();
        print_message("%s: %ld iterations, imbalance %.2g\n", names[b], run.iterations,
                      run.imbalance);
        assert_true(run.converged);
        assert_true(run.imbalance < 2e-3);
        assert_true(run.residual <= 1e-6);
        assert_close_relative(run.rows[3 * ROWS].force, run.rows[ROWS].force, 0.03);
        for (int i = 1; i <= 2 * ROWS; i++) {
            const struct wb_section_run_row *const row = &run.rows[i];
            /* Unloading is softer, and friction dissipates energy in both directions. */
            if (i > ROWS && row->phase == WB_PHASE_UNLOAD)
                assert_true(row->force < run.rows[2 * ROWS - i].force);
            assert_true(row->energies.friction >
                        friction - 0.01 * run.rows[ROWS].energies.external);
            friction = row->energies.friction;
        }
        assert_true(friction > 0.0);
    }
}

/* The weight bends a long bundle strongly. If it were applied in one increment, the trapezoidal
 * rule would miss half of its work, and a bundle of two metres would not converge. */
static void weight_of_a_long_bundle_is_applied_in_increments(void **unused)
{
    (void)unused;
    static const double lengths[] = {0.5, 2.0};

    for (int i = 0; i < 2; i++) {
        begin("7-type3", 10);
        model.length = lengths[i];
        model.run.deflection = 0.46 * lengths[i];
        model.loads = (struct wb_bundle_loads){.strand_length = 6.7 * lengths[i], .weight = true};
        compute();
        print_message("%g m: %d increments, imbalance %.2g\n", lengths[i], run.increments,
                      run.imbalance);
        assert_true(run.converged);
        assert_true(run.imbalance < 2e-3);
        /* The vertical force that holds the tip at zero deflection; for a propped elastic
         * cantilever it is 3/8 of the weight. */
        const double weight =
            WB_STANDARD_GRAVITY * lengths[i] *
            (wb_bundle_model_wire_mass(&model) + wb_bundle_model_tape_mass(&model));
        assert_true(run.zero_force > 0.3 * weight && run.zero_force < 0.5 * weight);
    }
}

static void vanishing_tape_or_friction_equals_none(void **unused)
{
    (void)unused;
    static const char *const names[] = {"7-type3", "12-type3-circle"};

    for (int i = 0; i < 2; i++) {
        begin(names[i], 12);
        model.tape.taping.layer_thickness = 1e-9;
        const double thin = last_force();
        begin(names[i], 12);
        model.has_tape = false;
        assert_close_relative(thin, last_force(), 2e-4);

        begin(names[i], 12);
        model.interface.friction.mu_static = model.interface.friction.mu_kinetic = 1e-9;
        const double slippery = last_force();
        model.interface.friction.mu_static = model.interface.friction.mu_kinetic = 0.0;
        assert_close_relative(slippery, last_force(), 1e-6);

        begin(names[i], 12);
        model.interface.shear_stiffness = 1e12;
        const double stiff = last_force();
        model.interface.shear_stiffness = 1e15;
        assert_close_relative(stiff, last_force(), 0.005);
    }
}

static void bend_radius_below_the_depth_is_reported(void **unused)
{
    (void)unused;
    begin("7-type3", 12);
    assert_true(last_force() > 2.0);
    assert_true(isnan(wb_section_run_folds(&run)));
    /* A length of 5 mm, about the diameter of the bundle. */
    model.length *= 5.0 / 114.0;
    model.run.deflection *= 5.0 / 114.0;
    last_force();
    const double folds = wb_section_run_folds(&run);
    print_message("5 mm: the bend radius is below the depth from %g mm on\n", folds * 1e3);
    assert_true(folds > 1e-3 && folds <= model.run.deflection);
    /* Half the depth (three wire radii) times the largest curvature, which is about twice the
     * tip's angle over the length. */
    assert_close_relative(run.rows[1].point.fold / run.rows[1].point.tip_angle,
                          3.0 * 0.7e-3 * 2.0 / model.length, 0.5);
}

/* The friction coefficient is so large that not even row 0 converges. */
static void run_without_equilibrium_has_no_rows(void **unused)
{
    (void)unused;
    begin("19-type3", 12);
    model.loads.weight = true;
    model.interface.friction.mu_static = model.interface.friction.mu_kinetic = 1e3;
    compute();
    assert_false(run.converged);
    assert_int_equal(run.n_rows, 0);
    assert_int_equal(run.n_curve, 0);
    assert_true(!(run.lost.residual <= 1e-6));
}

static void non_finite_states_do_not_converge(void **unused)
{
    (void)unused;
    struct wb_section_solver_point point;
    const struct wb_section_solver_settings settings = {.friction = 0.2};

    /* Without load, where all other terms are zero. */
    read_bundle("7-type3");
    model.interface.shear_stiffness = (double)NAN;
    create(&settings);
    wb_section_solver_move(solver, 0.0, &point);
    assert_int_equal(point.end, WB_SECTION_SOLVER_NOT_CONVERGED);
    destroy(NULL);
    /* A strand of 20 mm becomes horizontal before the tip reaches 90 mm. */
    read_bundle("7-type3");
    model.loads.strand_length = 20e-3;
    create(&settings);
    for (int i = 0; i <= 45 && point.end == WB_SECTION_SOLVER_CONVERGED; i++)
        wb_section_solver_move(solver, 2e-3 * i, &point);
    wb_section_solver_move(solver, 90e-3, &point);
    assert_int_equal(point.end, WB_SECTION_SOLVER_NOT_CONVERGED);
    assert_true(point.deflection < 70e-3 && isfinite(point.vertical));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(cycles_of_other_packings_repeat_and_balance_energy, release),
        cmocka_unit_test_teardown(weight_of_a_long_bundle_is_applied_in_increments, release),
        cmocka_unit_test_teardown(vanishing_tape_or_friction_equals_none, release),
        cmocka_unit_test_teardown(bend_radius_below_the_depth_is_reported, release),
        cmocka_unit_test_teardown(run_without_equilibrium_has_no_rows, release),
        TEST(non_finite_states_do_not_converge),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
