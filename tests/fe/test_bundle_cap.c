/* The capped tip: a frame in closed form, and what has to be kept. */
#include "tests/fe/bundles_lead.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(a_cap_makes_two_wires_a_frame, release),
        cmocka_unit_test(a_capped_bundle_keeps_energy_and_momentum),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
