#include "fe/material/law.h"
#include "fe/material/law_private.h"

#include <math.h>

#include "base/units.h"
#include "tests/check.h"
#include "tests/messages.h"

static struct wb_material ludwik(double E, double yield, double K, double n)
{
    return (struct wb_material){.hardening = WB_HARDENING_ISOTROPIC_POWER,
                                .youngs_modulus = E * WB_MPA,
                                .poissons_ratio = 0.39,
                                .yield_stress = yield * WB_MPA,
                                .strength_coefficient = K * WB_MPA,
                                .hardening_exponent = n};
}

/* Wires of the paper and beyond: E, sigma_Y, K (MPa), n. */
static const struct wb_material *materials(int *n)
{
    static struct wb_material list[6];
    list[0] = ludwik(5021, 3.9, 3222, 0.99);
    list[1] = ludwik(4312, 3.35, 676, 0.74);
    list[2] = ludwik(2827, 2.2, 463, 0.75);
    list[3] = ludwik(9000, 5.0, 100, 0.3);
    list[4] = ludwik(9000, 40.0, 100, 0.15);
    list[5] = ludwik(120000, 60.0, 400, 0.5);
    *n = 6;
    return list;
}

static void ludwiks_overlay_follows_its_curve(void **unused)
{
    (void)unused;
    int n;
    const struct wb_material *const list = materials(&n);
    for (int m = 0; m < n; m++) {
        struct wb_law law;
        struct wb_overlay overlay;
        wb_law_init_ludwik(&law, &list[m]);
        law.isotropic_share = 0.0;
        assert_int_equal(wb_law_check(&law, NULL), WB_OK);
        wb_law_overlay(&law, &overlay);
        assert_int_equal(overlay.n, WB_LAW_LUDWIK_PARTS);
        const double yield_strain = list[m].yield_stress / list[m].youngs_modulus;
        double worst = 0.0, sum = 0.0;
        int points = 0;
        for (double e = 0.1 * yield_strain; e < 0.1; e *= 1.003) {
            const double exact = wb_law_virgin_stress(&law, e, NULL);
            const double error = wb_law_overlay_stress(&overlay, e, NULL) / exact - 1.0;
            worst = fmax(worst, fabs(error));
            sum += error;
            points++;
        }
        print_message("    material %d: at most %.1e off, in the mean %.1e\n", m, worst,
                      sum / points);
        assert_true(worst < 2e-3 && fabs(sum) / points < 3e-4);
    }
}

static void an_overlays_parts_are_elastic_first_and_never_soften(void **unused)
{
    (void)unused;
    int n;
    const struct wb_material *const list = materials(&n);
    for (int m = 0; m < n; m++) {
        struct wb_law law;
        struct wb_overlay overlay;
        wb_law_init_ludwik(&law, &list[m]);
        wb_law_overlay(&law, &overlay);
        double sum = 0.0, before = 0.0;
        for (int i = 0; i < overlay.n; i++) {
            assert_true(overlay.modulus[i] >= 0.0);
            assert_true(overlay.yield_strain[i] > before);
            before = overlay.yield_strain[i];
            sum += overlay.modulus[i];
        }
        assert_close(sum, list[m].youngs_modulus, 1e-9 * sum);
        assert_close(overlay.yield_strain[0], list[m].yield_stress / list[m].youngs_modulus, 1e-15);
    }
}

static void the_virgin_curve_is_ludwiks(void **unused)
{
    (void)unused;
    const struct wb_material m = ludwik(4312, 3.35, 676, 0.74);
    struct wb_law law;
    wb_law_init_ludwik(&law, &m);
    assert_true(wb_law_is_plain(&law));
    for (double p = 1e-6; p < 0.1; p *= 3.0) {
        const double stress = m.yield_stress + m.strength_coefficient * pow(p, 0.74);
        const double strain = p + stress / m.youngs_modulus;
        double tangent;
        assert_close(wb_law_virgin_stress(&law, strain, &tangent), stress, 1e-10 * stress);
        const double H = 0.74 * m.strength_coefficient * pow(p, -0.26);
        assert_close(tangent, 1.0 / (1.0 / m.youngs_modulus + 1.0 / H), 1e-7 * tangent);
    }
}

static void parallel_parts_add_up(void **unused)
{
    (void)unused;
    const struct wb_law_part parts[] = {{3e9, 1e-3}, {1e9, 5e-3}, {2e8, (double)INFINITY}};
    struct wb_law law;
    double tangent;
    wb_law_init_parallel(&law, parts, 3, 0.0, 0.39);
    assert_int_equal(wb_law_check(&law, NULL), WB_OK);
    assert_close(law.material.youngs_modulus, 4.2e9, 1.0);
    assert_close(wb_law_virgin_stress(&law, 5e-4, &tangent), 4.2e9 * 5e-4, 1e-3);
    assert_close(tangent, 4.2e9, 1.0);
    assert_close(wb_law_virgin_stress(&law, 2e-3, &tangent), 3e6 + 1.2e9 * 2e-3, 1e-3);
    assert_close(tangent, 1.2e9, 1.0);
    assert_close(wb_law_virgin_stress(&law, 1e-2, &tangent), 3e6 + 5e6 + 2e6, 1e-3);
    assert_close(tangent, 2e8, 1.0);
}

static void what_makes_no_law_is_refused(void **unused)
{
    (void)unused;
    const struct wb_law_part good[] = {{3e9, 1e-3}, {1e9, 5e-3}};
    struct wb_law law;
    wb_law_init_parallel(&law, good, 2, 0.5, 0.39);
    assert_int_equal(wb_law_check(&law, NULL), WB_OK);
    law.isotropic_share = 1.1;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    wb_law_init_parallel(&law, good, 2, 0.5, 0.39);
    law.parts[1].yield_strain = 1e-3;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    wb_law_init_parallel(&law, good, 2, 0.5, 0.39);
    law.parts[0].yield_strain = (double)INFINITY;
    law.parts[1].yield_strain = 2 * (double)INFINITY;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    wb_law_init_parallel(&law, good, 2, 0.5, 0.39);
    law.parts[0].modulus = -1.0;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    wb_law_init_parallel(&law, good, 2, 0.5, 0.39);
    law.material.youngs_modulus *= 1.01;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    wb_law_init_parallel(&law, good, 0, 0.5, 0.39);
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);

    struct wb_material steepens = ludwik(5000, 4, 3000, 1.2);
    wb_law_init_ludwik(&law, &steepens);
    assert_int_equal(wb_law_check(&law, NULL), WB_OK);
    law.isotropic_share = 0.5;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
}

static void what_makes_no_combined_law_is_refused(void **unused)
{
    (void)unused;
    const struct wb_material elastic = {
        .youngs_modulus = 5e9, .poissons_ratio = 0.39, .yield_stress = 2e6};
    const struct wb_law_back back = {2e9, 500.0};
    struct wb_law good, law;
    wb_law_init_chaboche(&good, &elastic, 1e6, 200.0, &back, 1);
    assert_int_equal(wb_law_check(&good, NULL), WB_OK);
    assert_close(good.isotropic_share, 1e6 / (1e6 + 2e9 / 500.0), 1e-15);
    double *const numbers[] = {
        &law.material.youngs_modulus, &law.material.yield_stress, &law.saturation, &law.rate,
        &law.backs[0].modulus,        &law.backs[0].recovery};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        law = good;
        *numbers[i] = -1.0;
        assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
        *numbers[i] = (double)NAN;
        assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    }
    law = good;
    law.n_backs = WB_LAW_MOST_BACKS + 1;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    const struct wb_law_part part = {3e9, 1e-3};
    wb_law_init_parallel(&law, &part, 1, 0.5, 0.39);
    law.is_combined = true;
    assert_int_equal(wb_law_check(&law, NULL), WB_OK);
    law.isotropic_share = 1.0;
    assert_int_equal(wb_law_check(&law, NULL), WB_ERR_ARGUMENT);
    /* One surface gives no work back, however its growth steepens. */
    const struct wb_material steepens = ludwik(5000, 4, 3000, 1.2);
    wb_law_init_ludwik(&law, &steepens);
    law.isotropic_share = 0.5;
    law.is_combined = true;
    assert_int_equal(wb_law_check(&law, NULL), WB_OK);
}

static void rules_have_names(void **unused)
{
    (void)unused;
    const struct wb_law_part part = {3e9, 1e-3};
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, 0.0, 0.39);
    assert_string_equal(wb_law_rule_name(&law), "kinematic");
    law.isotropic_share = 0.3;
    assert_string_equal(wb_law_rule_name(&law), "mixed");
    law.isotropic_share = 1.0;
    assert_string_equal(wb_law_rule_name(&law), "isotropic");
    assert_false(wb_law_is_plain(&law));
    const struct wb_material m = ludwik(5000, 4, 3000, 0.8);
    wb_law_init_ludwik(&law, &m);
    law.isotropic_share = 1.0;
    law.is_combined = true;
    assert_string_equal(wb_law_rule_name(&law), "combined");
    assert_false(wb_law_is_plain(&law) || wb_law_is_overlay(&law));
    assert_true(wb_law_has_share(&law));
    wb_law_init_chaboche(&law, &m, 0.0, 0.0, NULL, 0);
    assert_string_equal(wb_law_rule_name(&law), "combined");
    assert_string_equal(wb_law_form_name(law.form), "chaboche");
    assert_false(wb_law_has_share(&law) || wb_law_is_overlay(&law));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ludwiks_overlay_follows_its_curve),
        cmocka_unit_test(an_overlays_parts_are_elastic_first_and_never_soften),
        cmocka_unit_test(the_virgin_curve_is_ludwiks),
        cmocka_unit_test(parallel_parts_add_up),
        cmocka_unit_test(what_makes_no_law_is_refused),
        cmocka_unit_test(what_makes_no_combined_law_is_refused),
        cmocka_unit_test(rules_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
