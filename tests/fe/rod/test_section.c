#include "fe/rod/section.h"

#include "tests/check.h"

static const struct wb_material pvc = {WB_HARDENING_NONE_ELASTIC, 50e6, 0.4, 0.0, 0.0, 0.0};
static const struct wb_material copper = {
    WB_HARDENING_ISOTROPIC_POWER, 5000e6, 0.39, 4e6, 900e6, 0.7};

/* Integral of y^k over the section. */
static double moment(const struct wb_section *section, int k)
{
    double sum = 0.0;
    for (int i = 0; i < section->n_fibres; i++)
        sum += section->fibres[i].area * pow(section->fibres[i].y, k);
    return sum;
}

static void circle_has_its_moments_exactly(void **unused)
{
    (void)unused;
    for (int n = 2; n <= 41; n++) {
        struct wb_section s;
        assert_int_equal(wb_section_init_circle(&s, 2.0, &copper, n), WB_OK);
        assert_int_equal(s.n_fibres, n);
        assert_close_relative(moment(&s, 0), M_PI, 1e-14);
        assert_close(moment(&s, 1), 0.0, 1e-15);
        assert_close_relative(moment(&s, 2), M_PI / 4.0, 1e-13);
        /* Degree 2 n - 1: the fourth moment, pi R^6 / 8, needs three points. */
        if (n >= 3)
            assert_close_relative(moment(&s, 4), M_PI / 8.0, 1e-13);
        wb_section_release(&s);
    }
}

static void default_circle_has_twenty_fibres(void **unused)
{
    (void)unused;
    struct wb_section s;
    assert_int_equal(wb_section_init_circle(&s, 1e-3, &copper, 0), WB_OK);
    assert_int_equal(s.n_fibres, 20);
    wb_section_release(&s);
}

static void ring_has_its_area_and_second_moment(void **unused)
{
    (void)unused;
    const int counts[] = {2, 7, 20, 33};
    for (size_t k = 0; k < 4; k++) {
        struct wb_section s;
        wb_section_init_empty(&s);
        assert_int_equal(wb_section_add_ring(&s, 1.4, 2.0, &pvc, 0.5, counts[k]), WB_OK);
        assert_close_relative(moment(&s, 0), 0.5 * M_PI * (1.0 - 0.49), 1e-12);
        assert_close(moment(&s, 1), 0.0, 1e-15);
        assert_close_relative(moment(&s, 2), 0.5 * M_PI / 4.0 * (1.0 - pow(0.7, 4)), 1e-12);
        for (int i = 0; i < s.n_fibres; i++)
            assert_true(s.fibres[i].area > 0.0 && fabs(s.fibres[i].y) <= 1.0);
        wb_section_release(&s);
    }
}

static void parts_add_up_with_their_materials(void **unused)
{
    (void)unused;
    struct wb_section s;
    wb_section_init_empty(&s);
    assert_int_equal(wb_section_add_ring(&s, 0.0, 0.7e-3, &copper, 0.4, 20), WB_OK);
    assert_int_equal(wb_section_add_ring(&s, 0.0, 0.7e-3, &pvc, 0.6, 20), WB_OK);
    assert_int_equal(wb_section_add_ring(&s, 0.7e-3, 1.1e-3, &pvc, 1.0, 20), WB_OK);
    assert_int_equal(s.n_materials, 3);
    assert_int_equal(s.n_fibres, 60);
    assert_close_relative(moment(&s, 0), M_PI / 4.0 * 1.1e-3 * 1.1e-3, 1e-12);
    for (int i = 0; i < 60; i++)
        assert_int_equal(s.fibres[i].material, i / 20);
    const double core = M_PI / 4.0 * 0.7e-3 * 0.7e-3;
    const double ring = M_PI / 4.0 * 1.1e-3 * 1.1e-3 - core;
    assert_close_relative(s.shear_stiffness,
                          wb_section_shear_modulus(&copper) * 0.4 * core +
                              wb_section_shear_modulus(&pvc) * (0.6 * core + ring),
                          1e-12);
    wb_section_release(&s);
}

static void shear_has_cowpers_factor(void **unused)
{
    (void)unused;
    struct wb_material m = pvc;
    m.poissons_ratio = 0.3;
    /* G k with G = E / 2.6 and k = 6 x 1.3 / (7 + 1.8) */
    assert_close_relative(wb_section_shear_modulus(&m), 50e6 / 2.6 * 7.8 / 8.8, 1e-14);
}

static void ignore_message(void *context, enum wb_log_level level, const char *domain,
                           const char *message)
{
    (void)level;
    (void)domain;
    (void)message;
    ++*(int *)context;
}

static void invalid_sections_are_rejected_with_one_message(void **unused)
{
    (void)unused;
    int messages = 0;
    struct wb_section s;
    struct wb_material bad[6];
    for (int i = 0; i < 6; i++)
        bad[i] = copper;
    bad[0].youngs_modulus = 0.0;
    bad[1].yield_stress = -1.0;
    bad[2].strength_coefficient = (double)NAN;
    bad[3].hardening_exponent = 0.0;
    bad[4].hardening_exponent = 2.5;
    bad[5].poissons_ratio = 0.6;

    wb_log_set_sink(ignore_message, &messages);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(wb_section_init_circle(&s, 1e-3, &bad[i], 0), WB_ERR_ARGUMENT);
        assert_int_equal(messages, i + 1);
    }
    assert_int_equal(wb_section_init_circle(&s, 0.0, &copper, 0), WB_ERR_ARGUMENT);
    assert_int_equal(wb_section_init_circle(&s, 1e-3, &copper, -1), WB_ERR_ARGUMENT);
    wb_section_init_empty(&s);
    assert_int_equal(wb_section_add_ring(&s, 2e-3, 1e-3, &pvc, 1.0, 0), WB_ERR_ARGUMENT);
    assert_int_equal(wb_section_add_ring(&s, 0.0, 1e-3, &pvc, 1.5, 0), WB_ERR_ARGUMENT);
    assert_int_equal(messages, 10);
    wb_log_set_sink(NULL, NULL);
    wb_section_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circle_has_its_moments_exactly),
        cmocka_unit_test(default_circle_has_twenty_fibres),
        cmocka_unit_test(ring_has_its_area_and_second_moment),
        cmocka_unit_test(parts_add_up_with_their_materials),
        cmocka_unit_test(shear_has_cowpers_factor),
        cmocka_unit_test(invalid_sections_are_rejected_with_one_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
