#include "fixtures/virtual/composite.h"

#include <stdlib.h>
#include <unistd.h>

#include "tests/virtual/setup.h"

static int errors;
static char last[512];

static void catch (void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)domain;
    errors += level == WB_LOG_ERROR;
    snprintf(last, sizeof last, "%s", message);
}

static void the_section_is_core_and_jacket(void **state)
{
    (void)state;
    static const char *const specimens[] = {"type1-L85-1", "type2-L85-1", "type3-L85-1"};
    for (int i = 0; i < 3; i++) {
        struct setup setup;
        struct wb_section section;
        setup_bench(&setup, specimens[i], 1);
        assert_int_equal(wb_composite_build_variant(&setup.composite, WB_COMPOSITE_KINEMATIC,
                                                    &setup.wire, 1.0, 1.0, 12, NULL, &section),
                         WB_OK);
        double area = 0.0, stiffness = 0.0;
        for (int k = 0; k < section.n_fibres; k++) {
            const struct wb_fibre *const fibre = &section.fibres[k];
            area += fibre->area;
            stiffness += section.materials[fibre->material].youngs_modulus * fibre->area *
                         fibre->y * fibre->y;
        }
        const double d = setup.wire.outer_diameter, dc = setup.wire.conductor_diameter;
        assert_close_relative(area, M_PI * d * d / 4.0, 1e-9);
        const double core = M_PI * pow(dc, 4.0) / 64.0, all = M_PI * pow(d, 4.0) / 64.0;
        assert_close_relative(stiffness,
                              setup.composite.core_modulus * core +
                                  setup.composite.jacket_modulus * (all - core),
                              1e-9);
        /* 1.12 times the paper's homogenised stiffness before the first yield. */
        assert_close_relative(stiffness, 1.12 * setup.wire.material.youngs_modulus * all, 0.005);
        wb_section_release(&section);
    }
}

static void scatter_multiplies_stiffness_and_yield(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_section plain, other;
    setup_bench(&setup, "type1-L85-1", 1);
    assert_int_equal(wb_composite_build_variant(&setup.composite, WB_COMPOSITE_KINEMATIC,
                                                &setup.wire, 1.0, 1.0, 12, NULL, &plain),
                     WB_OK);
    assert_int_equal(wb_composite_build_variant(&setup.composite, WB_COMPOSITE_KINEMATIC,
                                                &setup.wire, 1.1, 0.8, 12, NULL, &other),
                     WB_OK);
    for (int i = 0; i < plain.n_materials; i++) {
        assert_close_relative(other.materials[i].youngs_modulus,
                              1.1 * plain.materials[i].youngs_modulus, 1e-12);
        assert_close(other.materials[i].yield_stress, 0.8 * plain.materials[i].yield_stress, 1e-3);
        assert_close(other.materials[i].strength_coefficient,
                     1.1 * plain.materials[i].strength_coefficient, 1.0);
    }
    wb_section_release(&plain);
    wb_section_release(&other);
}

static void messages_for_invalid_files_name_the_key(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"wires: {a: {jacket_modulus_MPa: 25}}", "jacket_poisson"},
        {"wires: [1, 2]", "wires"},
        {"other: 1", "other"},
        {"wires: {a: {jacket_modulus_MPa: 25, jacket_poisson: 0.4, core_modulus_MPa: 1e4, "
         "core_poisson: 0.3, core_laws: [{area_percent: 50, yield_stress_MPa: 5, hardening_MPa: "
         "1}]}}",
         "adds up to 50"},
        {"wires: {a: {jacket_modulus_MPa: 25, jacket_poisson: 0.4, core_modulus_MPa: 1e4, "
         "core_poisson: 0.3, core_laws: []}}",
         "core_laws"},
        {"wires: {b: {}}", "wire 'a' has no entry"},
    };
    char path[] = "/tmp/wb-composite-XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    wb_log_set_sink(catch, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_composite composite;
        assert_int_equal(wb_file_write(path, cases[i].text, strlen(cases[i].text)), WB_OK);
        errors = 0;
        assert_int_not_equal(wb_composite_read(path, "a", &composite), WB_OK);
        assert_int_equal(errors, 1);
        if (!strstr(last, cases[i].message))
            fail_msg("'%s' does not say '%s'", last, cases[i].message);
    }
    wb_log_set_sink(NULL, NULL);
    close(file);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_section_is_core_and_jacket),
        cmocka_unit_test(scatter_multiplies_stiffness_and_yield),
        cmocka_unit_test(messages_for_invalid_files_name_the_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
