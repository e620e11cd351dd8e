/* The shipped fixtures read without a complaint and agree with each other and with the paper. */
#include "tests/check.h"

#include <glob.h>
#include <stdlib.h>

#include "base/config.h"
#include "base/file.h"
#include "base/units.h"
#include "daq/rig.h"
#include "daq/specimen.h"
#include "fe/wire.h"

/* Calls `look` with every shipped file that matches; there must be at least `least`. */
static void each_file(const char *pattern, size_t least, void (*look)(const char *path))
{
    char full[WB_PATH];
    glob_t found;
    assert_int_equal(wb_file_join(full, getenv("WIREBENCH_SOURCE_ROOT"), pattern), WB_OK);
    assert_int_equal(glob(full, 0, NULL, &found), 0);
    assert_true(found.gl_pathc >= least);
    for (size_t i = 0; i < found.gl_pathc; i++)
        look(found.gl_pathv[i]);
    globfree(&found);
}

static void look_at_wire(const char *path)
{
    struct wb_wire wire;
    assert_int_equal(wb_wire_read(path, &wire), WB_OK);
    assert_true(wire.has_properties);
    assert_true(strlen(wire.source) > 0);
    assert_true(wire.conductor_diameter < wire.outer_diameter);
}

static void wires_read(void **state)
{
    (void)state;
    each_file("fixtures/wires/*.yaml", 9, look_at_wire);
}

/* Eqs. 10 and 11 at one point: sigma_Y = 1.5 E (delta/L) (d/L), with delta/L = 0.040 in all rows.
 */
static void published_yield_stresses_belong_to_four_percent(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double length;
    } rows[] = {
        {"type1", 0.085},           {"type2", 0.085},     {"type3", 0.085},
        {"bundle-7", 0.114},        {"bundle-12", 0.114}, {"bundle-19", 0.114},
        {"bundle-19-mixed", 0.114}, {"bundle-27", 0.114},
    };
    for (size_t i = 0; i < WB_COUNT(rows); i++) {
        char path[WB_PATH];
        struct wb_wire wire;
        assert_int_equal(wb_file_find_fixture(path, "wires", rows[i].name, NULL), WB_OK);
        assert_int_equal(wb_wire_read(path, &wire), WB_OK);
        const double fraction = wire.material.yield_stress * rows[i].length /
                                (1.5 * wire.material.youngs_modulus * wire.outer_diameter);
        assert_close(fraction, 0.040, 0.0005);
    }
}

static void look_at_specimen(const char *path)
{
    struct wb_specimen specimen;
    char wire[WB_PATH];
    assert_int_equal(wb_specimen_read(path, &specimen), WB_OK);
    assert_int_equal(specimen.n_markers, 7);
    assert_true(specimen.markers[0] == 0.0);
    assert_close(specimen.markers[6], specimen.length, 1e-12);
    assert_int_equal(wb_file_find_fixture(wire, "wires", specimen.wire, NULL), WB_OK);
}

static void specimens_read_and_name_shipped_wires(void **state)
{
    (void)state;
    each_file("fixtures/specimens/*.yaml", 18, look_at_specimen);
}

static void look_at_rig(const char *path)
{
    struct wb_rig rig;
    assert_int_equal(wb_rig_read(path, &rig), WB_OK);
    assert_false(rig.is_virtual);
    assert_true(rig.load_cell.overload > rig.load_cell.capacity);
    assert_close(rig.strand.length, 0.760, 1e-12);
}

static void rigs_read(void **state)
{
    (void)state;
    each_file("fixtures/rigs/*.yaml", 2, look_at_rig);
}

struct member {
    char wire[64];
    int count;
};

static void read_member(const struct wb_config_node *node, struct member *member)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("wire", member->wire),
        WB_CONFIG_INTEGER("count", &member->count, 1, 1000),
    };
    assert_int_equal(wb_config_map(node, keys, WB_COUNT(keys)), WB_OK);
}

/* Mass of the wires and of 0.25 kg/m2 of tape, over the printed circle, is the printed density. */
static void look_at_bundle(const char *path)
{
    struct wb_config *config;
    const struct wb_config_node *wires, *published;
    char name[64], packing[32], tape[32], length_source[32];
    double length, diameter, density;
    assert_int_equal(wb_config_read(&config, path), WB_OK);
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", name),
        WB_CONFIG_NODE("wires", &wires),
        WB_CONFIG_TEXT("packing", packing),
        WB_CONFIG_TEXT("tape", tape),
        WB_CONFIG_NUMBER("length_mm", &length, WB_MM, 1, 1e4),
        WB_CONFIG_TEXT("length_source", length_source),
        WB_CONFIG_IGNORED("interface"),
        WB_CONFIG_NODE("published", &published),
    };
    assert_int_equal(wb_config_map(wb_config_root(config), keys, WB_COUNT(keys)), WB_OK);
    const struct wb_config_key published_keys[] = {
        WB_CONFIG_NUMBER("outer_diameter_mm", &diameter, WB_MM, 0.1, 100),
        WB_CONFIG_NUMBER("density_g_cm3", &density, WB_G_PER_CM3, 0.1, 20),
    };
    assert_int_equal(wb_config_map(published, published_keys, WB_COUNT(published_keys)), WB_OK);

    double mass = M_PI * (diameter - 0.2 * WB_MM) * 0.25;
    for (int i = 0; i < wb_config_length(wires); i++) {
        struct member member;
        char file[WB_PATH];
        struct wb_wire wire;
        read_member(wb_config_item(wires, i), &member);
        assert_int_equal(wb_file_find_fixture(file, "wires", member.wire, NULL), WB_OK);
        assert_int_equal(wb_wire_read(file, &wire), WB_OK);
        mass += member.count * wb_wire_mass_per_length(&wire);
    }
    assert_close_relative(mass / (M_PI * diameter * diameter / 4.0), density, 0.01);
    wb_config_destroy(config);
}

static void bundles_weigh_what_table_4_says(void **state)
{
    (void)state;
    each_file("fixtures/bundles/*.yaml", 5, look_at_bundle);
}

static void look_at_material(const char *path)
{
    struct wb_config *config;
    char name[64], source[200];
    bool substitute = false;
    double E, density, nu = 0.0, yield = 0.0, K = 0.0, n = 0.0, thickness = 0.0;
    assert_int_equal(wb_config_read(&config, path), WB_OK);
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", name),
        WB_CONFIG_OPTIONAL_BOOLEAN("substitute", &substitute),
        WB_CONFIG_TEXT("source", source),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &E, WB_MPA, 1, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("poissons_ratio", &nu, 1, 0, 0.5),
        WB_CONFIG_OPTIONAL_NUMBER("yield_stress_MPa", &yield, WB_MPA, 0.1, 1e4),
        WB_CONFIG_OPTIONAL_NUMBER("strength_coefficient_MPa", &K, WB_MPA, 0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("hardening_exponent", &n, 1, 0.01, 2),
        WB_CONFIG_NUMBER("density_g_cm3", &density, WB_G_PER_CM3, 0.1, 25),
        WB_CONFIG_OPTIONAL_NUMBER("thickness_of_two_layers_mm", &thickness, WB_MM, 0.01, 10),
    };
    assert_int_equal(wb_config_map(wb_config_root(config), keys, WB_COUNT(keys)), WB_OK);
    wb_config_destroy(config);
}

static void materials_are_complete(void **state)
{
    (void)state;
    each_file("fixtures/materials/*.yaml", 3, look_at_material);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wires_read),
        cmocka_unit_test(published_yield_stresses_belong_to_four_percent),
        cmocka_unit_test(specimens_read_and_name_shipped_wires),
        cmocka_unit_test(rigs_read),
        cmocka_unit_test(bundles_weigh_what_table_4_says),
        cmocka_unit_test(materials_are_complete),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
