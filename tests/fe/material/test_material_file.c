/* Material files: every key, and every refusal with file, line and key. */
#include "tests/messages.h"

#include <stdlib.h>
#include <unistd.h>

#include "fe/material/material_file.h"

static char path[] = "/tmp/wirebench-material-XXXXXX";

static enum wb_status read_text(const char *text, struct wb_material_file *file)
{
    FILE *const out = fopen(path, "w");
    assert_non_null(out);
    fputs(text, out);
    assert_int_equal(fclose(out), 0);
    keep_messages();
    const enum wb_status status = wb_material_file_read(file, path);
    wb_log_set_sink(NULL, NULL);
    return status;
}

#define HEAD "name: m\nsource: s\nyoungs_modulus_MPa: 100\ndensity_g_cm3: 2\n"

static void origin_and_intervals_are_read(void **state)
{
    (void)state;
    struct wb_material_file file;
    assert_int_equal(read_text(HEAD "origin: tensile tests\nintervals:\n"
                                    "  youngs_modulus_MPa: [90, 110]\n"
                                    "  hardening_exponent: [0.2, 0.8]\n",
                               &file),
                     WB_OK);
    assert_string_equal(file.origin, "tensile tests");
    assert_close_relative(file.interval[WB_MATERIAL_MODULUS][0], 90e6, 1e-15);
    assert_close_relative(file.interval[WB_MATERIAL_EXPONENT][1], 0.8, 1e-15);
    assert_true(isnan(file.interval[WB_MATERIAL_YIELD][0]));
    assert_int_equal(read_text(HEAD "intervals: {hardening_exponent: [0.8, 0.2]}\n", &file),
                     WB_ERR_FORMAT);
    assert_message("hardening_exponent: expected the least first");
    assert_int_equal(read_text(HEAD "intervals: {density: [1, 2]}\n", &file), WB_ERR_FORMAT);
    assert_message("density: unknown key");
}

static void every_key_is_read(void **state)
{
    (void)state;
    struct wb_material_file file;
    assert_int_equal(read_text(HEAD "substitute: true\npoissons_ratio: 0.3\nyield_stress_MPa: 3\n"
                                    "hardening: isotropic\nstrength_coefficient_MPa: 4\n"
                                    "hardening_exponent: 0.5\nthickness_of_two_layers_mm: 0.2\n",
                               &file),
                     WB_OK);
    assert_string_equal(file.name, "m");
    assert_string_equal(file.source, "s");
    assert_true(file.is_substitute);
    assert_close(file.material.youngs_modulus, 100e6, 1e-6);
    assert_close(file.material.poissons_ratio, 0.3, 0.0);
    assert_close(file.material.yield_stress, 3e6, 1e-9);
    assert_close(file.material.strength_coefficient, 4e6, 1e-9);
    assert_close(file.material.hardening_exponent, 0.5, 0.0);
    assert_close(file.density, 2000.0, 1e-9);
    assert_close(file.thickness, 0.2e-3, 1e-12);
    assert_int_equal(file.material.hardening, WB_HARDENING_ISOTROPIC_POWER);
}

static void what_is_left_out_has_a_meaning(void **state)
{
    (void)state;
    struct wb_material_file file;
    assert_int_equal(read_text(HEAD, &file), WB_OK);
    assert_int_equal(file.material.hardening, WB_HARDENING_NONE_ELASTIC);
    assert_true(isnan(file.material.poissons_ratio));
    assert_false(file.is_substitute);
    assert_close(file.thickness, 0.0, 0.0);

    assert_int_equal(read_text(HEAD "yield_stress_MPa: 3\n", &file), WB_OK);
    assert_int_equal(file.material.hardening, WB_HARDENING_ISOTROPIC_POWER);
    assert_close(file.material.strength_coefficient, 0.0, 0.0);
    assert_close(file.material.hardening_exponent, 1.0, 0.0);

    assert_int_equal(read_text(HEAD "yield_stress_MPa: 3\nhardening: kinematic\n"
                                    "strength_coefficient_MPa: 4\n",
                               &file),
                     WB_OK);
    assert_int_equal(file.material.hardening, WB_HARDENING_KINEMATIC_LINEAR);
    assert_close(file.material.strength_coefficient, 4e6, 1e-9);
}

static void refusals_name_line_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"name: m\n", ":1: source: this key is missing"},
        {HEAD "colour: red\n", ":5: colour: unknown key"},
        {HEAD "poissons_ratio: 0.5\n", ":5: poissons_ratio: 0.5 is out of range"},
        {HEAD "poissons_ratio: nan\n", ":5: poissons_ratio: expected a plain number"},
        {HEAD "yield_stress_MPa: 0\n", ":5: yield_stress_MPa: 0 is out of range"},
        {HEAD "substitute: yes\n", ":5: substitute: expected true or false"},
        {HEAD "hardening_exponent: 0.5\nstrength_coefficient_MPa: 3\n",
         ":1: yield_stress_MPa: this key is missing"},
        {HEAD "hardening: isotropic\n", ":1: yield_stress_MPa: this key is missing"},
        {HEAD "yield_stress_MPa: 1\nstrength_coefficient_MPa: 3\n",
         ":6: strength_coefficient_MPa: strength_coefficient_MPa must be given together with "
         "hardening_exponent"},
        {HEAD "yield_stress_MPa: 1\nhardening_exponent: 1\n",
         ":6: hardening_exponent: hardening_exponent must be given together with "
         "strength_coefficient_MPa"},
        {HEAD "yield_stress_MPa: 1\nhardening: kinematic\n", ":6: hardening: kinematic"},
        {HEAD "yield_stress_MPa: 1\nhardening: kinematic\nstrength_coefficient_MPa: 1\n"
              "hardening_exponent: 1\n",
         ":8: hardening_exponent: kinematic"},
        {HEAD "yield_stress_MPa: 1\nhardening: mixed\n",
         ":6: hardening: expected one of isotropic, kinematic"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_material_file file = {.name = "untouched"};
        assert_int_equal(read_text(cases[i].text, &file), WB_ERR_FORMAT);
        if (strncmp(kept.last, path, strlen(path)) != 0 || !strstr(kept.last, cases[i].expected))
            fail_msg("case %zu: '%s' does not hold '%s'", i, kept.last, cases[i].expected);
        assert_string_equal(file.name, "untouched");
    }
}

static int make_file(void **state)
{
    (void)state;
    const int descriptor = mkstemp(path);
    return descriptor < 0 ? -1 : close(descriptor);
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(origin_and_intervals_are_read),
        cmocka_unit_test(every_key_is_read),
        cmocka_unit_test(what_is_left_out_has_a_meaning),
        cmocka_unit_test(refusals_name_line_and_key),
    };
    return cmocka_run_group_tests(tests, make_file, remove_file);
}
