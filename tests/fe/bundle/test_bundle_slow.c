/* Bundles in explicit dynamics, tests that take minutes. */
#include "tests/fe/bundle/bundles.h"
#include "tests/fe/bundle/static_reference.h"

/* Runs the model and, with the 1D beam, the same loading; the force of each row must agree within
 * `limit` of the largest. Returns the number of slack rows. */
static int compare_with_beam(const struct wb_cantilever_model *beam, int cycles, double limit)
{
    enum {
        STEPS = 5
    };
    struct wb_cantilever *cantilever = test_cantilever(beam);
    const struct wb_loading_steps_plan plan = {.maximum = 50e-3, .steps = STEPS, .cycles = cycles};
    struct wb_loading_steps expected;
    double worst = 0.0;
    int slack = 0;

    assert_int_equal(wb_loading_steps_init(&expected, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&expected, &plan, cantilever), WB_OK);
    run_model(NULL);
    assert_true(result.converged);
    assert_int_equal(result.n_rows, 1 + 2 * cycles * STEPS);
    assert_int_equal(result.n_rows, expected.n_rows);
    const double largest = expected.rows[STEPS].force;
    for (int i = 0; i < result.n_rows; i++) {
        const struct wb_bundle_row *row = &result.rows[i];
        const double error = (row->force - expected.rows[i].force) / largest;
        assert_int_equal(row->phase, expected.rows[i].phase);
        assert_int_equal(row->cycle, expected.rows[i].cycle);
        assert_close(error, 0.0, limit);
        worst = fmax(worst, fabs(error));
        slack += row->phase == WB_PHASE_SLACK;
        if (row->phase == WB_PHASE_SLACK) {
            assert_true(row->tension == 0.0);
            assert_close_relative(row->deflection, expected.rows[i].point.deflection, 0.02);
        }
    }
    print_message("largest error of %d rows, %d of them slack: %.2f %% of the largest force\n",
                  result.n_rows, slack, 100.0 * worst);
    assert_true(result.largest.imbalance < 0.01);
    wb_loading_steps_release(&expected);
    wb_cantilever_destroy(cantilever);
    return slack;
}

/* Loading, unloading beyond the point where the strand becomes slack, and reloading from where it
 * is taut. */
static void cycles_with_a_strand_follow_the_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    struct wb_cantilever_model beam = bundle_beam(&wire, &section);
    beam.strand_length = 0.76;
    beam.gravity_y = -WB_STANDARD_GRAVITY;

    read_model(
        ONE RUN("deflection_mm: 50, rows: 5, cycles: 2, duration_s: 2.5") "loads: {strand_mm: 760, "
                                                                          "weight: true}\n");
    assert_true(compare_with_beam(&beam, 2, 0.015) >= 3);
    wb_section_release(&section);
}

/* A vertical force also pulls down, back to zero: the wire yields in both directions. */
static void cycles_follow_the_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    const struct wb_cantilever_model beam = bundle_beam(&wire, &section);

    read_model(ONE RUN("deflection_mm: 50, rows: 5, cycles: 2, duration_s: 2.5") "loads: {weight: "
                                                                                 "false}\n");
    assert_int_equal(compare_with_beam(&beam, 2, 0.015), 0);
    assert_true(result.rows[10].force < -0.5 * result.rows[5].force);
    wb_section_release(&section);
}

/* The ratio of energies is proportional to duration^-2. */
static void energies_balance_and_motion_is_slow_enough(void **unused)
{
    (void)unused;
    read_model(SEVEN "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 8, rows: 16}\n"
                     "loads: {weight: false}\n");
    run_model(NULL);
    assert_true(result.converged && result.chosen && !result.exceeded);
    assert_true(result.attempts <= 3);
    const double chosen = result.duration, ratio = result.largest.kinetic;
    assert_true(ratio > 0.02 && ratio <= 0.05);
    assert_true(result.largest.imbalance < 0.01);
    assert_true(result.largest.artificial < 0.05);
    check_work(&result);
    const struct wb_bundle_energies *e = &result.rows[result.n_rows - 1].energies;
    assert_true(e->friction > 0.0 && e->plastic > 0.0 && e->cohesive > 0.0 && e->contact > 0.0);

    model.run.duration = 0.5 * chosen;
    run_model(NULL);
    assert_true(!result.chosen && result.exceeded);
    assert_int_equal(result.attempts, 1);
    assert_close_relative(result.largest.kinetic, 4.0 * ratio, 0.3);
}

/* Side by side two wires are twice as stiff as one; one above the other they slide on each other,
 * because nothing presses them together, and their sections do not stay plane. */
static void two_wires_are_twice_as_stiff_as_one(void **unused)
{
    (void)unused;
    enum {
        ROWS_OF_TWO = 15
    };
    double force[3];
    static const char *const places[] = {
        ONE,
        "wires: [{wire: type3, count: 2}]\npacking: places\nplaces_mm: [[0, -0.7], [0, 0.7]]\n",
        "wires: [{wire: type3, count: 2}]\npacking: places\nplaces_mm: [[-0.7, 0], [0.7, 0]]\n",
    };
    for (int i = 0; i < 3; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", places[i],
                 RUN("deflection_mm: 15, rows: 15, duration_s: 1") "loads: {weight: false}\n");
        read_model(text);
        run_model(NULL);
        assert_true(result.converged);
        assert_true(result.largest.imbalance < 0.01);
        check_work(&result);
        force[i] = result.rows[ROWS_OF_TWO].force;
    }
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(&model);
    assert_close_relative(force[1], 2.0 * force[0], 1e-3);
    assert_true(force[2] > 1.99 * force[0]);
    assert_true(force[2] < 2.0 * force[0] * rigidity.bonded[0] / rigidity.sliding[0]);
}

/* The engineering mesh: within 1.5 % of the beam from 10 to 53 mm. */
static void one_wire_is_within_the_mesh_error_of_the_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    const struct wb_cantilever_model beam = bundle_beam(&wire, &section);
    struct wb_cantilever *cantilever = test_cantilever(&beam);
    double worst = 0.0;

    read_model(ONE "run: {deflection_mm: 53, rows: 53, selective_mass_scaling: 100}\n"
                   "loads: {weight: false}\n");
    run_model(NULL);
    assert_true(result.converged && !result.exceeded);
    assert_int_equal(result.hexahedra, 960);
    for (int i = 10; i <= 53; i++) {
        const struct wb_bundle_row *row = &result.rows[i];
        struct wb_cantilever_point point;
        assert_int_equal(
            wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, row->deflection, &point), WB_OK);
        worst = fmax(worst, fabs(row->force / point.tension - 1.0));
    }
    print_message("largest error from 10 to 53 mm: %.2f %%, %lld steps\n", 100.0 * worst,
                  result.steps);
    assert_true(worst < 0.015);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* The shipped bundle of seven in the elastic range: force over deflection lies between those for
 * freely sliding wires and tape and for plane sections. */
static void seven_wires_are_between_sliding_and_bonded(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", "7-type3", NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    model.loads.weight = false;
    model.loads.strand_length = 0.0;
    model.run.selective = 100.0;
    model.run.deflection = 4e-3;
    model.run.rows = 8;
    run_model(NULL);
    assert_true(result.converged && !result.exceeded);
    assert_true(result.largest.imbalance < 0.01);
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(&model);
    for (int i = 5; i <= 8; i++) {
        const struct wb_bundle_row *row = &result.rows[i];
        const double EI = row->force * pow(model.length, 3.0) / (3.0 * row->deflection);
        print_message("%g mm: E I between %g and %g N mm2: %g\n", row->deflection * 1e3,
                      rigidity.sliding[0] * 1e6, rigidity.bonded[0] * 1e6, EI * 1e6);
        assert_true(EI > rigidity.sliding[0] && EI < rigidity.bonded[0]);
    }
}

/* Friction of 0.1, because only in the explicit model do wires roll. */
static void curve_is_within_five_percent_of_the_static_reference(void **unused)
{
    (void)unused;
    const int n = sizeof static_7_every_mm / sizeof static_7_every_mm[0];
    double worst = 0.0;

    read_model(SEVEN "run: {selective_mass_scaling: 100, deflection_mm: 53, rows: 53, "
                     "duration_s: 2}\nloads: {weight: false}\n");
    model.interface.friction.mu_static = model.interface.friction.mu_kinetic = 0.1;
    run_model(NULL);
    assert_true(result.converged && !result.exceeded);
    for (int i = 0; i < n; i++) {
        const struct static_point *expected = &static_7_every_mm[i];
        const struct wb_bundle_row *row = &result.rows[i + 2];
        const double error = row->force / expected->force - 1.0;
        assert_close(row->deflection, expected->deflection_mm * 1e-3, 1e-6);
        if (i % 10 == 0 || i + 1 == n)
            print_message("%4.1f mm: static %.4f N, explicit %.4f N, %+.1f %%\n",
                          expected->deflection_mm, expected->force, row->force, 100.0 * error);
        worst = fmax(worst, fabs(error));
        assert_close(row->tip[0], expected->tip_x_mm * 1e-3, 0.5e-3);
    }
    assert_true(worst < 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(cycles_with_a_strand_follow_the_beam, release),
        cmocka_unit_test_teardown(cycles_follow_the_beam, release),
        cmocka_unit_test_teardown(energies_balance_and_motion_is_slow_enough, release),
        cmocka_unit_test_teardown(one_wire_is_within_the_mesh_error_of_the_beam, release),
        cmocka_unit_test_teardown(two_wires_are_twice_as_stiff_as_one, release),
        cmocka_unit_test_teardown(seven_wires_are_between_sliding_and_bonded, release),
        cmocka_unit_test_teardown(curve_is_within_five_percent_of_the_static_reference, release),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
