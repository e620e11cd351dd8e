/* Wires of layers compared with closed forms. */
#include "analysis/calibration/constituents/layers.h"

#include "base/file.h"
#include "base/units.h"
#include "fe/material/material_file.h"
#include "tests/check.h"

static struct wb_material material(double modulus, double yield, double ratio)
{
    return (struct wb_material){.youngs_modulus = modulus,
                                .poissons_ratio = ratio,
                                .yield_stress = yield,
                                .hardening_exponent = 1.0,
                                .hardening = yield > 0.0 ? WB_HARDENING_ISOTROPIC_POWER
                                                         : WB_HARDENING_NONE_ELASTIC};
}

static void eqs_8_and_9_give_the_8awg_wire(void **state)
{
    (void)state;
    struct wb_material_file copper, pvc;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "materials", "annealed-copper", NULL), WB_OK);
    assert_int_equal(wb_material_file_read(&copper, path), WB_OK);
    assert_int_equal(wb_file_find_fixture(path, "materials", "pvc", NULL), WB_OK);
    assert_int_equal(wb_material_file_read(&pvc, path), WB_OK);
    const struct wb_layers layers = {copper.material, pvc.material, 3.26e-3, 4.86e-3, 0, 0.0};
    const double second_moment = M_PI * pow(4.86e-3, 4.0) / 64.0;
    assert_close_relative(wb_layers_rigidity(&layers, false) / second_moment, 13.84e9, 1e-3);
    assert_close(wb_layers_poissons_ratio(&layers), 0.39, 0.005);
}

static void elastic_moments_are_rigidity_times_curvature(void **state)
{
    (void)state;
    const struct wb_layers layers = {
        material(117e9, 0.0, 0.34), material(40e6, 0.0, 0.43), 0.8e-3, 1.2e-3, 60, 0.08e-3};
    static const double curvature[3] = {0.0, 1.0, 50.0};
    double moment[3];
    for (int sliding = 0; sliding < 2; sliding++) {
        assert_int_equal(wb_layers_moments(&layers, sliding, curvature, 3, moment, NULL), WB_OK);
        for (int i = 0; i < 3; i++)
            assert_close_relative(moment[i], wb_layers_rigidity(&layers, sliding) * curvature[i],
                                  1e-9);
    }
    /* Sliding strands have 60 d^4 instead of fill x D^4. */
    const double copper_bonded = 60 * pow(0.08, 2.0) * pow(0.8, 2.0),
                 copper_free = 60 * pow(0.08, 4.0);
    const double jacket = pow(1.2, 4.0) - pow(0.8, 4.0), share = 40e6 / 117e9;
    assert_close_relative(wb_layers_rigidity(&layers, false) / wb_layers_rigidity(&layers, true),
                          (copper_bonded + share * jacket) / (copper_free + share * jacket), 1e-12);
}

static void a_perfectly_plastic_conductor_reaches_its_plastic_moment(void **state)
{
    (void)state;
    const struct wb_layers solid = {
        material(117e9, 100e6, 0.34), material(0.0, 0.0, 0.0), 1e-3, 1e-3, 0, 0.0};
    struct wb_layers strands = solid;
    static const double curvature[1] = {1000.0}; /* 600 times the yield curvature */
    double moment[1];
    assert_int_equal(wb_layers_moments(&solid, false, curvature, 1, moment, NULL), WB_OK);
    assert_close_relative(moment[0], 100e6 * 1e-9 / 6.0, 1e-3);
    strands.strands = 19;
    strands.strand_diameter = 0.2e-3;
    assert_int_equal(wb_layers_moments(&strands, true, curvature, 1, moment, NULL), WB_OK);
    assert_close_relative(moment[0], 19 * 100e6 * 8e-12 / 6.0, 2e-3);
    assert_int_equal(wb_layers_moments(&strands, false, curvature, 1, moment, NULL), WB_OK);
    assert_close_relative(moment[0], 19 * 0.04 * 100e6 * 1e-9 / 6.0, 1e-3);
}

/* M(kappa) of sigma_Y + K ep^n, n = 1, in closed form over a circle by Simpson's rule. */
static void the_moment_of_a_hardening_conductor_is_the_integral_over_its_section(void **state)
{
    (void)state;
    struct wb_material copper = material(117e9, 100e6, 0.34);
    copper.strength_coefficient = 2e9;
    const struct wb_layers solid = {copper, material(0.0, 0.0, 0.0), 1e-3, 1e-3, 0, 0.0};
    static const double curvature[3] = {1.0, 5.0, 100.0};
    double moment[3];
    assert_int_equal(wb_layers_moments(&solid, false, curvature, 3, moment, NULL), WB_OK);
    for (int i = 0; i < 3; i++) {
        enum {
            N = 20000
        };
        double sum = 0.0;
        for (int k = 0; k < N; k++) {
            const double y = 0.5e-3 * (k + 0.5) / N, e = curvature[i] * y;
            const double plastic = (117e9 * e - 100e6) / (117e9 + 2e9);
            const double stress = plastic > 0.0 ? 100e6 + 2e9 * plastic : 117e9 * e;
            sum += 4.0 * stress * y * sqrt(0.25e-6 - y * y) * 0.5e-3 / N;
        }
        assert_close_relative(moment[i], sum, 1e-3);
    }
}

static void inconsistent_layers_are_rejected(void **state)
{
    (void)state;
    const struct wb_material copper = material(117e9, 0.0, 0.34);
    const struct {
        struct wb_layers layers;
        const char *expected;
    } cases[] = {
        {{copper, copper, 1e-3, 0.9e-3, 0, 0.0}, "the outer diameter (0.9 mm)"},
        {{copper, copper, 1e-3, 1e-3, 30, 0.2e-3}, "30 strands of 0.2 mm do not fit"},
        {{copper, copper, 1e-3, 1e-3, 30, 0.0}, "strands and their diameter go together"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_reason why = {{0}};
        const double curvature = 1.0;
        double moment;
        assert_int_equal(wb_layers_moments(&cases[i].layers, false, &curvature, 1, &moment, &why),
                         WB_ERR_ARGUMENT);
        if (!strstr(why.text, cases[i].expected))
            fail_msg("'%s' does not say '%s'", why.text, cases[i].expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eqs_8_and_9_give_the_8awg_wire),
        cmocka_unit_test(elastic_moments_are_rigidity_times_curvature),
        cmocka_unit_test(a_perfectly_plastic_conductor_reaches_its_plastic_moment),
        cmocka_unit_test(the_moment_of_a_hardening_conductor_is_the_integral_over_its_section),
        cmocka_unit_test(inconsistent_layers_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
