/* The sheet's material point in plane stress. */
#include "tests/check.h"
#include "tests/twin/bundle_static_sheet.h"
#include "tests/twin/material_stress.h"

/* The paper's tape. */
static const struct wb_bundle_static_sheet tape = {
    {WB_HARDENING_ISOTROPIC_POWER, 119e6, 0.4, 2.4e6, 16.3e6, 0.73}};

static double mises(const double s[3])
{
    return sqrt(s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 3.0 * s[2] * s[2]);
}

/* The strain across that makes the stress across vanish. */
static void pull(struct wb_bundle_static_sheet_state *state, double strain, double *across,
                 struct wb_bundle_static_sheet_response *r)
{
    struct wb_bundle_static_sheet_state after;

    for (int i = 0; i < 60; i++) {
        const double e[3] = {strain, *across, 0.0};
        wb_bundle_static_sheet_respond(&tape, e, state, &after, r);
        if (fabs(r->stress[1]) < 1e-6)
            break;
        *across -= r->stress[1] / r->tangent[1][1];
    }
    assert_true(fabs(r->stress[1]) < 1e-6);
    *state = after;
}

static void uniaxial_tension_follows_the_power_law(void **unused)
{
    (void)unused;
    struct wb_bundle_static_sheet_state state = {0};
    struct wb_material_state bar = {0};
    struct wb_bundle_static_sheet_response r;
    double across = 0.0;
    static const double path[] = {0.01, 0.02, 0.03, 0.05, 0.08, 0.05, 0.02, -0.02};

    for (int i = 0; i < 8; i++) {
        double stress, slope;
        wb_material_stress(&tape.material, path[i], &bar, &bar, &stress, &slope);
        pull(&state, path[i], &across, &r);
        assert_close_relative(r.stress[0], stress, 1e-6);
        assert_close(state.accumulated, bar.accumulated_plastic_strain, 1e-9);
    }
    assert_true(state.accumulated > 0.05);
}

/* Shear: the angle is the elastic one and sqrt(3) times the plastic strain. */
static void shear_follows_the_power_law(void **unused)
{
    (void)unused;
    const double G = 119e6 / 2.8;
    const double strain[3] = {0.0, 0.0, 0.15};
    struct wb_bundle_static_sheet_state state = {0}, after;
    struct wb_bundle_static_sheet_response r;

    wb_bundle_static_sheet_respond(&tape, strain, &state, &after, &r);
    const double p = after.accumulated, flow = 2.4e6 + 16.3e6 * pow(p, 0.73);
    assert_close_relative(r.stress[2], flow / sqrt(3.0), 1e-9);
    assert_close_relative(r.stress[2] / G + sqrt(3.0) * p, 0.15, 1e-9);
    assert_close(r.stress[0], 0.0, 1e-3);
}

static void stresses_lie_on_the_surface_and_plastic_flow_keeps_the_volume(void **unused)
{
    (void)unused;
    const double strain[3] = {0.05, -0.02, 0.04};
    struct wb_bundle_static_sheet_state state = {0}, after, more;
    struct wb_bundle_static_sheet_response r;

    wb_bundle_static_sheet_respond(&tape, strain, &state, &after, &r);
    const double flow = wb_material_flow_stress(&tape.material, after.accumulated);
    assert_close_relative(mises(r.stress), flow, 1e-10);
    /* Equivalent plastic strain of its components, with the one across the sheet. */
    const double *e = after.plastic;
    assert_close_relative(
        after.accumulated,
        sqrt(4.0 / 3.0 * (e[0] * e[0] + e[1] * e[1] + e[0] * e[1]) + e[2] * e[2] / 3.0), 1e-10);
    /* During unloading it is elastic. */
    const double back[3] = {0.045, -0.018, 0.036};
    wb_bundle_static_sheet_respond(&tape, back, &after, &more, &r);
    assert_true(more.accumulated == after.accumulated && mises(r.stress) < flow);
}

static void tangent_is_the_derivative_of_stress(void **unused)
{
    (void)unused;
    static const double points[][3] = {
        {0.005, 0.002, 0.003}, {0.05, -0.02, 0.04}, {0.021, 0.0, 0.0}, {-0.06, -0.06, 0.01}};

    for (int i = 0; i < 4; i++) {
        struct wb_bundle_static_sheet_state state = {{0.001, 0.0, -0.002}, 0.003}, after;
        struct wb_bundle_static_sheet_response r, up, down;
        wb_bundle_static_sheet_respond(&tape, points[i], &state, &after, &r);
        for (int k = 0; k < 3; k++) {
            double e[3] = {points[i][0], points[i][1], points[i][2]};
            e[k] += 1e-7;
            wb_bundle_static_sheet_respond(&tape, e, &state, &after, &up);
            e[k] -= 2e-7;
            wb_bundle_static_sheet_respond(&tape, e, &state, &after, &down);
            for (int m = 0; m < 3; m++) {
                assert_close((up.stress[m] - down.stress[m]) / 2e-7, r.tangent[m][k], 1e-5 * 119e6);
                assert_close(r.tangent[m][k], r.tangent[k][m], 1e-9 * 119e6);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(uniaxial_tension_follows_the_power_law),
        cmocka_unit_test(shear_follows_the_power_law),
        cmocka_unit_test(stresses_lie_on_the_surface_and_plastic_flow_keeps_the_volume),
        cmocka_unit_test(tangent_is_the_derivative_of_stress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
