/* Tape and wires: bonds, breaking bonds, contact, and a helix. */
#include "tests/fe/bundle/bundles_lead.h"

static void break_bonds_at(double strength, double fracture_energy)
{
    model.interface.has_damage = true;
    model.interface.damage = (struct wb_bundle_damage){
        .strength = strength, .shear_strength = strength, .fracture_energy = fracture_energy};
}

static void debonded_tape_stays_around_its_wire(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.15};
    struct wb_bundle_limits limits;
    struct wb_bundle_energies e;
    struct wb_bundle *bundle;

    read_model(ONE "tape: tape\n" RUN("deflection_mm: 30") "loads: {weight: false}\n");
    break_bonds_at(300.0, 1e-4);
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    move_and_check(bundle, 30e-3, settings.duration, 0.005);
    wb_bundle_get_limits(bundle, &limits);
    wb_bundle_get_energies(bundle, &e);
    assert_true(limits.debonded > 0.7); /* nodes under pressure stay bonded */
    assert_true(limits.tape_deepest > 0.0 && limits.tape_deepest < 1e-6);
    assert_true(e.contact > 0.0 && e.friction > 0.0 && e.cohesive > 0.0);
    wb_bundle_destroy(bundle);
}

/* Adhesive that fails in shear where wires and tape slide most: the bundle becomes softer, and the
 * dissipated energy is at most the fracture energy of the broken area. */
static void seven_wires_debond_and_energies_balance(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.1};
    struct wb_bundle_limits limits[2];
    struct wb_bundle_energies e[2];
    struct wb_bundle *bundle;

    read_model(SEVEN "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 15}\n"
                     "loads: {strand_mm: 760, weight: true}\n");
    for (int i = 0; i < 2; i++) {
        if (i == 1)
            break_bonds_at(8e3, 0.1);
        assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
        move_and_check(bundle, 10e-3, settings.duration, 0.01);
        wb_bundle_get_limits(bundle, &limits[i]);
        wb_bundle_get_energies(bundle, &e[i]);
        wb_bundle_destroy(bundle);
        assert_true(limits[i].tape_deepest < 10e-6);
    }
    assert_true(limits[0].debonded == 0.0 && limits[1].debonded > 0.3);
    assert_true(e[1].external < 0.8 * e[0].external);
    assert_true(e[1].cohesive < 0.1 * model.tape.taping.circumference * model.length);
}

/* A real winding, half-lapped: its mass is the tape's, there are no forces before the bundle bends,
 * and energy and momentum are conserved; either hand. */
static void a_helix_conserves_energy_and_momentum(void **unused)
{
    (void)unused;
    static const char *const hands[2] = {"left", "right"};
    const struct wb_bundle_settings settings = {.duration = 0.012, .mesh = "four"};
    struct wb_bundle_energies e[2];
    struct outside outside;
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
        assert_int_equal(wb_bundle_advance(bundle, 1, NULL), WB_OK);
        get_outside(bundle, &outside);
        const double mass = wb_bundle_model_wire_mass(&model) + wb_bundle_model_tape_mass(&model);
        const double tape = wb_bundle_model_tape_mass(&model);
        assert_close(outside.weight[1], -WB_STANDARD_GRAVITY * model.length * mass,
                     0.02 * WB_STANDARD_GRAVITY * model.length * tape);
        wb_bundle_destroy(bundle);

        model.loads.weight = false;
        assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
        move_and_check(bundle, 1e-3, settings.duration, 0.005);
        wb_bundle_get_energies(bundle, &e[i]);
        wb_bundle_destroy(bundle);
    }
    assert_close_relative(e[0].external, e[1].external, 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(debonded_tape_stays_around_its_wire),
        cmocka_unit_test(seven_wires_debond_and_energies_balance),
        cmocka_unit_test(a_helix_conserves_energy_and_momentum),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
