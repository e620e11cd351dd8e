/* The tape's wall of the section model (fe/section/section_sheet.h): in plane stress against its
 * slow twin, as a tube against a bar, and its tangent against differences. */
#include "fe/section/section_sheet.h"

#include <stdlib.h>

#include "tests/check.h"
#include "tests/twin/bundle_static_sheet.h"
#include "tests/twin/material_stress.h"

/* The paper's tape. */
static const struct wb_material tape = {
    WB_HARDENING_ISOTROPIC_POWER, 119e6, 0.4, 2.4e6, 16.3e6, 0.73};

static double noise(void)
{
    return 2.0 * rand() / RAND_MAX - 1.0;
}

static void a_path_in_plane_stress_is_that_of_the_twin(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_sheet twin = {tape};
    struct wb_section_sheet sheet;
    struct wb_bundle_static_sheet_state expected_state = {0};
    struct wb_section_sheet_state before = {0}, after = {0};
    double strain[3] = {0};

    assert_int_equal(wb_section_sheet_init(&sheet, &tape, false), WB_OK);
    srand(3);
    for (int step = 0; step < 2000; step++) {
        struct wb_bundle_static_sheet_response expected;
        struct wb_section_sheet_response found;
        for (int i = 0; i < 3; i++)
            strain[i] = 0.97 * strain[i] + 0.02 * noise();
        wb_bundle_static_sheet_respond(&twin, strain, &expected_state, &expected_state, &expected);
        wb_section_sheet_respond(&sheet, strain, &before, &after, &found);
        before = after;
        assert_close(after.accumulated, expected_state.accumulated, 1e-9);
        for (int i = 0; i < 3; i++) {
            assert_close(found.stress[i], expected.stress[i], 1e-6 * tape.yield_stress);
            for (int k = 0; k < 3; k++)
                assert_close(found.tangent[i][k], expected.tangent[i][k],
                             1e-6 * tape.youngs_modulus);
        }
    }
    assert_true(before.accumulated > 0.5);
}

static void a_tube_is_a_bar_in_tension_and_yields_in_shear_at_a_root_of_a_third(void **unused)
{
    (void)unused;
    static const double path[] = {0.01, 0.02, 0.03, 0.05, 0.08, 0.05, 0.02, -0.02};
    struct wb_section_sheet sheet;
    struct wb_section_sheet_state state = {0}, after = {0};
    struct wb_section_sheet_response r;
    struct wb_material_state bar = {0};

    assert_int_equal(wb_section_sheet_init(&sheet, &tape, true), WB_OK);
    for (int i = 0; i < 8; i++) {
        const double strain[3] = {path[i], 0.7, 0.0};
        double stress, slope;
        wb_material_stress(&tape, path[i], &bar, &bar, &stress, &slope);
        wb_section_sheet_respond(&sheet, strain, &state, &after, &r);
        state = after;
        assert_close_relative(r.stress[0], stress, 1e-9);
        assert_close(r.stress[1], 0.0, 0.0);
        assert_close(state.accumulated, bar.accumulated_plastic_strain, 1e-10);
    }
    const struct wb_section_sheet_state virgin = {0};
    const double G = 0.5 * tape.youngs_modulus / (1.0 + tape.poissons_ratio);
    const double yields = tape.yield_stress / sqrt(3.0) / G;
    for (int i = 0; i < 2; i++) {
        const double strain[3] = {0.0, 0.0, yields * (i == 0 ? 0.999 : 1.001)};
        wb_section_sheet_respond(&sheet, strain, &virgin, &after, &r);
        assert_int_equal(after.accumulated > 0.0, i);
    }
}

static void the_tangent_is_the_derivative_of_the_stress(void **unused)
{
    (void)unused;
    const double strain[3] = {0.05, -0.02, 0.06};
    const double step = 1e-6;

    for (int tube = 0; tube < 2; tube++) {
        struct wb_section_sheet sheet;
        struct wb_section_sheet_response at, up, down;
        const struct wb_section_sheet_state before = {{0.005, -0.002, 0.004}, 0.01};
        assert_int_equal(wb_section_sheet_init(&sheet, &tape, tube), WB_OK);
        for (int k = 0; k < 3; k++) {
            struct wb_section_sheet_state after = before;
            double more[3], less[3];
            memcpy(more, strain, sizeof more);
            memcpy(less, strain, sizeof less);
            more[k] += step;
            less[k] -= step;
            wb_section_sheet_respond(&sheet, strain, &before, &after, &at);
            wb_section_sheet_respond(&sheet, more, &before, &after, &up);
            wb_section_sheet_respond(&sheet, less, &before, &after, &down);
            assert_true(after.accumulated > before.accumulated);
            for (int i = 0; i < 3; i++)
                assert_close(at.tangent[i][k], (up.stress[i] - down.stress[i]) / (2.0 * step),
                             1e-5 * tape.youngs_modulus);
        }
    }
}

static void a_surface_that_moves_is_refused(void **unused)
{
    (void)unused;
    struct wb_material moving = tape;
    struct wb_section_sheet sheet;
    moving.hardening = WB_HARDENING_KINEMATIC_LINEAR;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_section_sheet_init(&sheet, &moving, false), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_path_in_plane_stress_is_that_of_the_twin),
        cmocka_unit_test(a_tube_is_a_bar_in_tension_and_yields_in_shear_at_a_root_of_a_third),
        cmocka_unit_test(the_tangent_is_the_derivative_of_the_stress),
        cmocka_unit_test(a_surface_that_moves_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
