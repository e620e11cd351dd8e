/* Bundles in explicit dynamics, on meshes that are coarse so that it is fast: against the 1D beam,
 * statics, and what has to be kept. */
#include "tests/fe/bundles.h"

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
    assert_true(history.converged);
    assert_int_equal(history.n_rows, 5);
    for (int i = 1; i <= 4; i++) {
        const struct wb_bundle_row *row = &history.rows[i];
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

/* The wire hangs between clamp and tip, an elastic beam held at one end and supported at the
 * other (15 elements are 2.2 % stiffer): v = w x^2 (3 L^2 - 5 L x + 2 x^2) / (48 E I), reactions
 * 5/8 and 3/8 w L. */
static void under_its_weight_it_hangs_as_a_propped_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    const double L = 0.114, w = test_wire_mass(&wire) * WB_STANDARD_GRAVITY;
    const double EI = wire.material.youngs_modulus * M_PI / 64.0 * pow(wire.diameter, 4.0);
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct wb_bundle_outside outside;
    struct wb_bundle_state state;
    struct wb_bundle *bundle;
    double s[19], shape[19][3];

    read_model(ONE RUN("deflection_mm: 40") "loads: {weight: true}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    assert_int_equal(wb_bundle_settle(bundle), WB_OK);
    for (int i = 0; i < 19; i++)
        s[i] = L * (i + 1) / 20;
    wb_bundle_shape(bundle, 19, s, shape);
    for (int i = 0; i < 19; i++) {
        const double x = s[i];
        const double v = w * x * x * (3.0 * L * L - 5.0 * L * x + 2.0 * x * x) / (48.0 * EI);
        assert_close(shape[i][1], -v, 0.025 * w * pow(L, 4.0) / (185.0 * EI));
    }
    wb_bundle_get_outside(bundle, &outside);
    wb_bundle_get_state(bundle, &state);
    assert_close_relative(outside.weight[1], -w * L, 1e-9);
    assert_close_relative(outside.clamp[1], 5.0 / 8.0 * w * L, 0.01);
    assert_close_relative(state.vertical, 3.0 / 8.0 * w * L, 0.01);
    wb_bundle_destroy(bundle);
}

/* --- several --- */

/* Contact, cohesion and elements give no force to the whole: in every step the momentum changes by
 * clamp, tip and weight alone. */
static void momentum_comes_from_outside_alone(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.05};
    struct wb_bundle_outside outside;
    struct wb_bundle *bundle;
    double impulse[3] = {0.0}, size = 0.0;

    read_model(SEVEN "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 20}\n"
                     "loads: {strand_mm: 760, weight: true}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_lead(bundle, 20e-3, settings.duration);
    for (int i = 0; i < 2000; i++) {
        const double dt = wb_bundle_time_step(bundle) * (i == 0 ? 0.5 : 1.0);
        assert_int_equal(wb_bundle_advance(bundle, 1), WB_OK);
        wb_bundle_get_outside(bundle, &outside);
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

/* --- tape and wires --- */

/* Leads the tip to a deflection. Energies are kept to the part given of the largest work, momentum
 * to what single precision leaves. */
static void lead_and_check(struct wb_bundle *bundle, double deflection, double duration,
                           double tolerance)
{
    const int steps = (int)(duration / wb_bundle_time_step(bundle));
    struct wb_bundle_outside outside;
    struct wb_bundle_energies e;
    double impulse[3] = {0.0}, size = 0.0, most = 0.0, worst = 0.0;

    wb_bundle_lead(bundle, deflection, duration);
    for (int i = 0; i < steps; i++) {
        const double dt = wb_bundle_time_step(bundle) * (i == 0 ? 0.5 : 1.0);
        assert_int_equal(wb_bundle_advance(bundle, 1), WB_OK);
        wb_bundle_get_outside(bundle, &outside);
        for (int c = 0; c < 3; c++) {
            const double force = outside.clamp[c] + outside.tip[c] + outside.weight[c];
            impulse[c] += force * dt;
            size += fabs(force * dt);
        }
        if (i % 50 != 0)
            continue;
        wb_bundle_get_energies(bundle, &e);
        most = fmax(most, fabs(e.external));
        if (i < steps / 10)
            continue;
        worst = fmax(worst, fabs(wb_bundle_imbalance(&e)) / most);
        for (int c = 0; c < 3; c++)
            assert_close(outside.momentum[c], impulse[c], 1e-5 * size);
    }
    print_message("energies are kept to %.3g %% in %d steps\n", 100.0 * worst, steps);
    assert_true(worst < tolerance);
}

static void break_bonds_at(double strength, double fracture_energy)
{
    model.interface.has_damage = true;
    model.interface.damage = (struct wb_bundle_damage){
        .strength = strength, .shear_strength = strength, .fracture_energy = fracture_energy};
}

static void a_tape_that_came_loose_stays_round_its_wire(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.2};
    struct wb_bundle_limits limits;
    struct wb_bundle_energies e;
    struct wb_bundle *bundle;

    read_model(ONE "tape: tape\n" RUN("deflection_mm: 30") "loads: {weight: false}\n");
    break_bonds_at(500.0, 1e-4);
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    lead_and_check(bundle, 30e-3, settings.duration, 0.005);
    wb_bundle_get_limits(bundle, &limits);
    wb_bundle_get_energies(bundle, &e);
    assert_true(limits.debonded > 0.9);
    assert_true(limits.tape_deepest > 0.0 && limits.tape_deepest < 1e-6);
    assert_true(e.contact > 0.0 && e.friction > 0.0 && e.cohesive > 0.0);
    wb_bundle_destroy(bundle);
}

/* Adhesive that shear breaks where wires and tape slide most: the bundle gets softer, what was
 * dissipated is no more than the fracture energy of the area that broke. */
static void seven_wires_come_loose_and_energies_are_kept(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.12};
    struct wb_bundle_limits limits[2];
    struct wb_bundle_energies e[2];
    struct wb_bundle *bundle;

    read_model(SEVEN "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 15}\n"
                     "loads: {strand_mm: 760, weight: true}\n");
    for (int i = 0; i < 2; i++) {
        if (i == 1)
            break_bonds_at(8e3, 0.1);
        assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
        lead_and_check(bundle, 10e-3, settings.duration, 0.01);
        wb_bundle_get_limits(bundle, &limits[i]);
        wb_bundle_get_energies(bundle, &e[i]);
        wb_bundle_destroy(bundle);
        assert_true(limits[i].tape_deepest < 10e-6);
    }
    assert_true(limits[0].debonded == 0.0 && limits[1].debonded > 0.3);
    assert_true(e[1].external < 0.8 * e[0].external);
    assert_true(e[1].cohesive < 0.1 * model.tape.taping.circumference * model.length);
}

/* A real winding, half-lapped: its mass is the tape's, nothing pulls before the bundle bends, and
 * energy and momentum are kept; either hand. */
static void a_helix_keeps_energy_and_momentum(void **unused)
{
    (void)unused;
    static const char *const hands[2] = {"left", "right"};
    const struct wb_bundle_settings settings = {.duration = 0.02, .mesh = "four"};
    struct wb_bundle_energies e[2];
    struct wb_bundle_outside outside;
    struct wb_bundle *bundle;

    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 SEVEN "taping: {layout: helix, width_mm: 19, hand: %s}\n" RUN(
                     "deflection_mm: 1") "loads: {weight: true}\n",
                 hands[i]);
        read_model(text);
        model.length = 20e-3;
        for (int m = 0; m < model.n_meshes; m++)
            model.mesh[m].elements_along = 40;
        assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
        assert_int_equal(wb_bundle_shells(bundle), 60 * 40);
        assert_int_equal(wb_bundle_advance(bundle, 1), WB_OK);
        wb_bundle_get_outside(bundle, &outside);
        const double mass = wb_bundle_model_wire_mass(&model) + wb_bundle_model_tape_mass(&model);
        const double tape = wb_bundle_model_tape_mass(&model);
        assert_close(outside.weight[1], -WB_STANDARD_GRAVITY * model.length * mass,
                     0.02 * WB_STANDARD_GRAVITY * model.length * tape);
        wb_bundle_destroy(bundle);

        model.loads.weight = false;
        assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
        lead_and_check(bundle, 1e-3, settings.duration, 0.005);
        wb_bundle_get_energies(bundle, &e[i]);
        wb_bundle_destroy(bundle);
    }
    assert_close_relative(e[0].external, e[1].external, 0.01);
}

/* --- a capped tip --- */

/* Two wires, one above the other, that do not touch: by the cap they are a frame. With the slope t
 * of the tip, one is E A t h / (2 L) in tension, the other in compression, and either gets the
 * moment -E A t h^2 / (4 L): F L^3 / (E I d) = 1 / (1/6 - k / (8 (1 + k))), k = A h^2 / (4 I); 6
 * without the cap. */
static void a_cap_makes_two_wires_a_frame(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    const double h = 1.6e-3, d = wire.diameter, L = 0.114, k = 4.0 * h * h / (d * d);
    const double EI = wire.material.youngs_modulus * M_PI / 64.0 * pow(d, 4.0);
    const double expected[2] = {6.0, 1.0 / (1.0 / 6.0 - k / (8.0 * (1.0 + k)))};
    static const char *const tip[2] = {"free", "capped"};

    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 "wires: [{wire: type3, count: 2}]\npacking: places\n"
                 "places_mm: [[-0.8, 0], [0.8, 0]]\nends: {tip: %s}\n" RUN(
                     "deflection_mm: 0.4, rows: 2, duration_s: 1") "loads: {weight: false}\n",
                 tip[i]);
        read_model(text);
        run_model(NULL);
        const struct wb_bundle_row *row = &history.rows[2];
        assert_close_relative(row->force * pow(L, 3.0) / (EI * row->deflection), expected[i], 0.01);
        assert_true(history.largest.imbalance < 0.01);
    }
}

static void a_capped_bundle_keeps_energy_and_momentum(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.1};
    struct wb_bundle *bundle;

    read_model(SEVEN "ends: {tip: capped}\n"
                     "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 15}\n"
                     "loads: {strand_mm: 760, weight: true}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    lead_and_check(bundle, 15e-3, settings.duration, 0.005);
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
    assert_true(history.stopped && history.converged);
    assert_int_equal(history.n_rows, 5);
    assert_close(history.rows[4].deflection, 4e-3, 1e-5);
    assert_true(history.rows[4].force > history.rows[3].force);
}

static void what_cannot_be_computed_is_refused(void **unused)
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
    assert_int_equal(wb_bundle_run_init(&history, &model, 1), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(one_wire_bends_as_the_beam, release),
        cmocka_unit_test(under_its_weight_it_hangs_as_a_propped_beam),
        cmocka_unit_test(momentum_comes_from_outside_alone),
        cmocka_unit_test(a_tape_that_came_loose_stays_round_its_wire),
        cmocka_unit_test(seven_wires_come_loose_and_energies_are_kept),
        cmocka_unit_test(a_helix_keeps_energy_and_momentum),
        cmocka_unit_test_teardown(a_cap_makes_two_wires_a_frame, release),
        cmocka_unit_test(a_capped_bundle_keeps_energy_and_momentum),
        cmocka_unit_test_teardown(a_stopped_run_keeps_its_rows, release),
        cmocka_unit_test_teardown(what_cannot_be_computed_is_refused, release),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
