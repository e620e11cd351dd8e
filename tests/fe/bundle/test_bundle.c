/* Bundles in explicit dynamics, on coarse meshes for speed: comparison with the 1D beam and
 * statics, and conservation laws. */
#include "tests/fe/bundle/bundles.h"
#include "tests/fe/bundle/outside.h"

/* --- one wire --- */

/* 15 elements of this mesh are within 1.5 % of the beam where it yields. */
static void one_wire_bends_as_the_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    const struct wb_cantilever_model beam = bundle_beam(&wire, &section);
    struct wb_cantilever *cantilever = test_cantilever(&beam);

    read_model(ONE RUN("deflection_mm: 40, rows: 4") "loads: {weight: false}\n");
    run_model(NULL);
    assert_true(result.converged);
    assert_int_equal(result.n_rows, 5);
    for (int i = 1; i <= 4; i++) {
        const struct wb_bundle_row *row = &result.rows[i];
        struct wb_cantilever_point point;
        assert_close(row->deflection, 10e-3 * i, 2e-6);
        assert_int_equal(
            wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, row->deflection, &point), WB_OK);
        assert_close_relative(row->force, point.tension, 0.015);
        assert_close(row->tip[0], point.tip_x, 2e-4);
        assert_close(row->tip_angle, point.tip_angle, 0.02);
    }
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* The wire is an elastic beam clamped at one end and supported at the other (15 elements are 2.2 %
 * stiffer): v = w x^2 (3 L^2 - 5 L x + 2 x^2) / (48 E I), reactions 5/8 and 3/8 w L. */
static void weight_deflects_the_wire_like_a_propped_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    const double L = 0.114, w = test_wire_mass(&wire) * WB_STANDARD_GRAVITY;
    const double EI = wire.material.youngs_modulus * M_PI / 64.0 * pow(wire.diameter, 4.0);
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct outside outside;
    struct wb_bundle_state state;
    struct wb_bundle *bundle;
    double s[19], shape[19][3];

    read_model(ONE RUN("deflection_mm: 40") "loads: {weight: true}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    assert_int_equal(wb_bundle_settle(bundle, NULL, NULL), WB_OK);
    for (int i = 0; i < 19; i++)
        s[i] = L * (i + 1) / 20;
    wb_bundle_shape(bundle, 19, s, shape);
    for (int i = 0; i < 19; i++) {
        const double x = s[i];
        const double v = w * x * x * (3.0 * L * L - 5.0 * L * x + 2.0 * x * x) / (48.0 * EI);
        assert_close(shape[i][1], -v, 0.025 * w * pow(L, 4.0) / (185.0 * EI));
    }
    get_outside(bundle, &outside);
    wb_bundle_get_state(bundle, &state);
    assert_close_relative(outside.weight[1], -w * L, 1e-9);
    assert_close_relative(outside.clamp[1], 5.0 / 8.0 * w * L, 0.01);
    assert_close_relative(state.vertical, 3.0 / 8.0 * w * L, 0.01);
    wb_bundle_destroy(bundle);
}

/* --- several --- */

/* Contact, cohesion and elements are internal forces: in every step only clamp, tip and weight
 * change the momentum. */
static void only_external_forces_change_the_momentum(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.05};
    struct outside outside;
    struct wb_bundle *bundle;
    double impulse[3] = {0.0}, size = 0.0;

    read_model(SEVEN "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 20}\n"
                     "loads: {strand_mm: 760, weight: true}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_move_tip(bundle, 20e-3, settings.duration);
    for (int i = 0; i < 2000; i++) {
        const double dt = wb_bundle_time_step(bundle) * (i == 0 ? 0.5 : 1.0);
        assert_int_equal(wb_bundle_advance(bundle, 1, NULL), WB_OK);
        get_outside(bundle, &outside);
        for (int c = 0; c < 3; c++) {
            const double force = outside.clamp[c] + outside.tip[c] + outside.weight[c];
            impulse[c] += force * dt;
            size += fabs(force * dt);
            assert_close(outside.momentum[c], impulse[c], 1e-5 * size);
        }
    }
    assert_true(fabs(outside.momentum[1]) > 0.05 * size);
    wb_bundle_destroy(bundle);
}

/* --- ends of a run --- */

static bool stop_beyond(void *context, const struct wb_bundle_progress *progress)
{
    return progress->deflection < *(double *)context;
}

static void a_stopped_run_keeps_its_rows(void **unused)
{
    (void)unused;
    double limit = 5e-3;
    const struct wb_bundle_observer observer = {.progress = stop_beyond, .context = &limit};
    read_model(ONE RUN("deflection_mm: 10, rows: 10, duration_s: 0.5") "loads: {weight: false}\n");
    run_model(&observer);
    assert_true(result.stopped && result.converged);
    assert_int_equal(result.n_rows, 5);
    assert_close(result.rows[4].deflection, 4e-3, 1e-5);
    assert_true(result.rows[4].force > result.rows[3].force);
}

struct rest {
    int looks;
    long long steps;
};

static bool stop_at_rest(void *context, const struct wb_bundle_progress *progress)
{
    struct rest *rest = context;
    assert_true(progress->rests && progress->done == 0.0);
    assert_true(rest->looks == 0 || progress->steps > rest->steps);
    rest->steps = progress->steps;
    return ++rest->looks < 3;
}

static void a_run_can_be_stopped_while_settling(void **unused)
{
    (void)unused;
    struct rest rest = {0};
    const struct wb_bundle_observer observer = {.progress = stop_at_rest, .context = &rest};
    read_model(ONE RUN("deflection_mm: 10, rows: 10") "loads: {weight: true}\n");
    run_model(&observer);
    assert_true(result.stopped && result.converged);
    assert_int_equal(rest.looks, 3);
    assert_int_equal(result.n_rows, 0);
}

static void too_short_strand_is_reported(void **unused)
{
    (void)unused;
    read_model(ONE "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 60, rows: 4, "
                   "duration_s: 0.3}\nloads: {weight: false, strand_mm: 10}\n");
    wb_log_set_sink(discard_message, NULL);
    run_model(NULL);
    wb_log_set_sink(NULL, NULL);
    assert_false(result.converged);
    assert_non_null(strstr(result.reason.text, "strand length 10 mm"));
}

/* Equivalent to a wire shortened by the potted length. */
static void a_potted_wire_bends_like_a_shorter_one(void **unused)
{
    (void)unused;
    double force[2][5], clamp[2];
    for (int i = 0; i < 2; i++) {
        const int held = 3;
        read_model(ONE RUN("deflection_mm: 20, rows: 4, duration_s: 1") "loads: {weight: false}\n");
        const double element = model.length / 15.0;
        for (int m = 0; m < model.n_meshes && i == 0; m++)
            model.mesh[m].elements_along -= held;
        model.length -= i == 0 ? held * element : 0.0;
        model.potted_length = i == 0 ? 0.0 : held * element;
        run_model(NULL);
        assert_int_equal(result.n_rows, 5);
        for (int row = 0; row < 5; row++)
            force[i][row] = result.rows[row].force;
        clamp[i] = result.rows[4].tip[0] - (i == 0 ? 0.0 : held * element);
    }
    for (int row = 1; row < 5; row++)
        assert_close_relative(force[1][row], force[0][row], 1e-4);
    assert_close(clamp[1], clamp[0], 1e-7);
}

/* Positions are always double; float forces change the curve by round-off. */
static void double_precision_gives_the_same_curve(void **unused)
{
    (void)unused;
    double force[2][5];
    for (int i = 0; i < 2; i++) {
        read_model(SEVEN
                   "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 20, rows: 4, "
                   "duration_s: 0.2, precision: single}\nloads: {weight: false}\n");
        assert_false(model.run.double_precision);
        model.run.double_precision = i == 1;
        run_model(NULL);
        assert_true(result.converged);
        for (int row = 0; row < 5; row++)
            force[i][row] = result.rows[row].force;
    }
    for (int row = 1; row < 5; row++)
        assert_close_relative(force[1][row], force[0][row], 1e-3);
    assert_true(force[1][4] != force[0][4]);
}

static void unsupported_models_are_rejected(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 1.0, .mesh = "none"};
    const struct wb_bundle_settings usual = {.duration = 1.0};
    struct wb_bundle *bundle;
    wb_log_set_sink(discard_message, NULL);
    read_model(ONE RUN("rows: 1") "loads: {weight: false}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_ERR_NOT_FOUND);
    assert_null(bundle);
    read_model(SEVEN
               "taping: {layout: helix, width_mm: 19}\n" RUN("rows: 1") "loads: {weight: false}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &usual), WB_ERR_ARGUMENT);
    assert_null(bundle);
    assert_int_equal(wb_bundle_result_init(&result, &model, 1), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(one_wire_bends_as_the_beam, release),
        cmocka_unit_test(weight_deflects_the_wire_like_a_propped_beam),
        cmocka_unit_test(only_external_forces_change_the_momentum),
        cmocka_unit_test_teardown(a_stopped_run_keeps_its_rows, release),
        cmocka_unit_test_teardown(a_run_can_be_stopped_while_settling, release),
        cmocka_unit_test_teardown(too_short_strand_is_reported, release),
        cmocka_unit_test_teardown(a_potted_wire_bends_like_a_shorter_one, release),
        cmocka_unit_test_teardown(double_precision_gives_the_same_curve, release),
        cmocka_unit_test_teardown(unsupported_models_are_rejected, release),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
