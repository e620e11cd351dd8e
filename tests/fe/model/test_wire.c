#include "fe/model/wire.h"

#include <stdlib.h>

#include "base/units.h"
#include "tests/messages.h"

static const char *const good = "name: sample\n"
                                "conductor_diameter_mm: 0.70\n"
                                "outer_diameter_mm: 1.10\n"
                                "density_g_cm3: 4.06\n";
static const char *const properties = "properties:\n"
                                      "  source: here\n"
                                      "  youngs_modulus_MPa: 5021\n"
                                      "  poissons_ratio: 0.39\n"
                                      "  yield_stress_MPa: 3.90\n"
                                      "  strength_coefficient_MPa: 3222\n"
                                      "  hardening_exponent: 0.99\n";

static void file_is_read_into_si_units(void **unused)
{
    (void)unused;
    char text[1024];
    struct wb_wire wire;
    snprintf(text, sizeof text, "%s%s", good, properties);
    assert_int_equal(wb_wire_parse(text, "test", &wire, NULL), WB_OK);
    assert_string_equal(wire.name, "sample");
    assert_close_relative(wire.conductor_diameter, 0.7e-3, 1e-15);
    assert_close_relative(wire.outer_diameter, 1.1e-3, 1e-15);
    assert_close_relative(wire.density, 4060.0, 1e-15);
    assert_true(wire.has_properties);
    assert_string_equal(wire.source, "here");
    assert_int_equal(wire.material.hardening, WB_HARDENING_ISOTROPIC_POWER);
    assert_close_relative(wire.material.youngs_modulus, 5021e6, 1e-15);
    assert_close_relative(wire.material.yield_stress, 3.9e6, 1e-15);
    assert_close_relative(wire.material.strength_coefficient, 3222e6, 1e-15);
    assert_true(wire.material.poissons_ratio == 0.39 && wire.material.hardening_exponent == 0.99);
    assert_close_relative(wb_wire_second_moment(&wire), M_PI * pow(1.1e-3, 4) / 64.0, 1e-14);
    assert_close_relative(wb_wire_mass_per_length(&wire), 4060.0 * M_PI * 1.21e-6 / 4.0, 1e-14);
}

static void properties_may_be_missing(void **unused)
{
    (void)unused;
    struct wb_wire wire;
    assert_int_equal(wb_wire_parse(good, "test", &wire, NULL), WB_OK);
    assert_false(wire.has_properties);
    assert_true(wire.outer_diameter_uncertainty == 0.0 && wire.density_uncertainty == 0.0);
}

static void stated_uncertainties_are_read(void **unused)
{
    (void)unused;
    char text[1024];
    struct wb_wire wire;
    snprintf(text, sizeof text, "%su_outer_diameter_mm: 0.02\nu_density_percent: 1.5\n", good);
    assert_int_equal(wb_wire_parse(text, "test", &wire, NULL), WB_OK);
    assert_close_relative(wire.outer_diameter_uncertainty, 2e-5, 1e-15);
    assert_close_relative(wire.density_uncertainty, 0.015, 1e-15);
}

static void bad_wires_are_refused_by_file_line_and_key(void **unused)
{
    (void)unused;
    static const struct {
        const char *line, *instead, *expected;
    } cases[] = {
        {"outer_diameter_mm: 1.10", "outer_diameter_mm: 1.10 mm", "outer_diameter_mm"},
        {"outer_diameter_mm: 1.10", "outer_diameter_mm: 0.5", "conductor_diameter_mm"},
        {"density_g_cm3: 4.06", "density_g_cm3: -4", "density_g_cm3"},
        {"density_g_cm3: 4.06", "density_kg_m3: 4060", "density_kg_m3"},
        {"name: sample", "# no name", "name"},
        {"  hardening_exponent: 0.99", "  hardening_exponent: 3", "hardening_exponent"},
        {"  youngs_modulus_MPa: 5021", "  youngs_modulus_MPa: nan", "youngs_modulus_MPa"},
        {"  yield_stress_MPa: 3.90", "", "yield_stress_MPa"},
    };
    keep_messages();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024], changed[1024];
        struct wb_wire wire = {.name = "untouched"};
        snprintf(text, sizeof text, "%s%s", good, properties);
        const char *at = strstr(text, cases[i].line);
        assert_non_null(at);
        snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, cases[i].instead,
                 at + strlen(cases[i].line));
        kept.n = 0;
        assert_int_not_equal(wb_wire_parse(changed, "bad.yaml", &wire, NULL), WB_OK);
        assert_int_equal(kept.n, 1);
        assert_message("bad.yaml");
        assert_message(cases[i].expected);
        assert_string_equal(wire.name, "untouched");
    }
    wb_log_set_sink(NULL, NULL);
}

static void shipped_wires_are_the_papers(void **unused)
{
    (void)unused;
    /* Tables 2 and 3, and 4 and 5 with eq. 11 at 0.04 L: sigma_Y = 1.5 E 0.04 d / L. */
    static const struct {
        const char *name;
        double length, E;
    } wires[] = {
        {"type1", 0.085, 5021e6},    {"type2", 0.085, 5641e6},          {"type3", 0.085, 4528e6},
        {"bundle-7", 0.114, 1114e6}, {"bundle-12", 0.114, 1022e6},      {"bundle-19", 0.114, 616e6},
        {"bundle-27", 0.114, 449e6}, {"bundle-19-mixed", 0.114, 442e6},
    };
    const char *source = getenv("WIREBENCH_SOURCE_ROOT");
    for (size_t i = 0; i < sizeof wires / sizeof wires[0]; i++) {
        char path[4096];
        struct wb_wire wire;
        snprintf(path, sizeof path, "%s/fixtures/wires/%s.yaml", source ? source : ".",
                 wires[i].name);
        assert_int_equal(wb_wire_read(path, &wire, NULL), WB_OK);
        assert_string_equal(wire.name, wires[i].name);
        assert_true(wire.has_properties);
        assert_close_relative(wire.material.youngs_modulus, wires[i].E, 1e-12);
        const double rule = 1.5 * wires[i].E * 0.04 * wire.outer_diameter / wires[i].length;
        assert_close_relative(wire.material.yield_stress, rule, 0.012);
    }
    char path[4096];
    struct wb_wire wire;
    snprintf(path, sizeof path, "%s/fixtures/wires/8awg.yaml", source ? source : ".");
    assert_int_equal(wb_wire_read(path, &wire, NULL), WB_OK);
}

/* What `wirebench calibrate -o` writes; keys that do not describe the wire are left to the reader
 * of properties. */
static const char *const calibrated = "schema: 1\n"
                                      "wire: \"sample\"\n"
                                      "outer_diameter_mm: 1.1\n"
                                      "mass_per_length_kg_m: 0.00386\n"
                                      "youngs_modulus_MPa: 5021\n"
                                      "yield_stress_MPa: 3.90\n"
                                      "strength_coefficient_MPa: 3222\n"
                                      "hardening_exponent: 0.99\n"
                                      "poissons_ratio: 0.39\n"
                                      "law:\n"
                                      "  form: parallel\n"
                                      "  hardening: kinematic\n"
                                      "  parts:\n"
                                      "    - {modulus_MPa: 2600, yield_strain: 0.0012}\n"
                                      "    - {modulus_MPa: 350}\n"
                                      "residual_curvature_ratio: {value: 0.158}\n";

static void properties_file_is_a_wire(void **unused)
{
    (void)unused;
    struct wb_wire wire;
    assert_int_equal(wb_wire_parse(calibrated, "p.yaml", &wire, NULL), WB_OK);
    assert_string_equal(wire.name, "sample");
    assert_string_equal(wire.source, "p.yaml");
    assert_true(wire.has_properties && wire.conductor_diameter == 0.0);
    assert_close_relative(wire.outer_diameter, 1.1e-3, 1e-15);
    assert_close_relative(wb_wire_mass_per_length(&wire), 0.00386, 1e-14);
    assert_int_equal(wire.law.form, WB_LAW_PARALLEL);
    assert_int_equal(wire.law.n_parts, 2);
    assert_true(wire.law.isotropic_share == 0.0);
}

static void properties_file_without_a_key_is_refused(void **unused)
{
    (void)unused;
    static const char *const keys[] = {"mass_per_length_kg_m", "outer_diameter_mm",
                                       "poissons_ratio"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        char text[1024];
        struct wb_wire wire;
        struct wb_reason why = {.text = ""};
        snprintf(text, sizeof text, "%s", calibrated);
        *strstr(text, keys[i]) = 'x';
        assert_int_equal(wb_wire_parse(text, "p.yaml", &wire, &why), WB_ERR_FORMAT);
        assert_non_null(strstr(why.text, "p.yaml:1: "));
        assert_non_null(strstr(why.text, keys[i]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(file_is_read_into_si_units),
        cmocka_unit_test(properties_may_be_missing),
        cmocka_unit_test(stated_uncertainties_are_read),
        cmocka_unit_test(bad_wires_are_refused_by_file_line_and_key),
        cmocka_unit_test(shipped_wires_are_the_papers),
        cmocka_unit_test(properties_file_is_a_wire),
        cmocka_unit_test(properties_file_without_a_key_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
