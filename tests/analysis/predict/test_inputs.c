/* Hardening rules of the wires in bundles with drawn inputs, as used for predictions. */
#include "analysis/predict/inputs.h"

#include "base/file.h"
#include "base/text.h"
#include "tests/check.h"
#include "tests/own_folder.h"

static struct wb_bundle_model model;
static struct wb_inputs inputs;

static const char bundle[] =
    "name: seven\nwires: [{wire: type3, count: 7}]\npacking: hexagon\nlength_mm: 114\n"
    "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.2}\n"
    "run: {deflection_mm: 20, rows: 5}\nloads: {weight: false}\nuncertainty:\n"
    "  wires: [{wire: type3, properties: properties.yaml, youngs_modulus_percent: 5, "
    "yield_stress_percent: 5, stress_percent: 5}]\n"
    "  diameter_percent: 0\n  pitch_percent: 0\n  length_percent: 0\n  friction: [0.2, 0.2]\n";

static const char properties[] = "wire: type3\nouter_diameter_mm: 1.4\n"
                                 "mass_per_length_kg_m: 0.00765\nyoungs_modulus_MPa: 4000\n"
                                 "yield_stress_MPa: 4\nstrength_coefficient_MPa: 1000\n"
                                 "hardening_exponent: 0.9\npoissons_ratio: 0.39\nlaw:\n";

/* Two parts in parallel. Without growth of the yield limits the stress at a strain of 0.02 is
 * 3000 * 0.002 + 1000 * 0.01 = 16 MPa. */
#define PARTS                                                                                      \
    "  parts:\n    - {modulus_MPa: 3000, yield_strain: 0.002}\n"                                   \
    "    - {modulus_MPa: 1000, yield_strain: 0.01}\n"

static void write_text(const char *name, const char *first, const char *second, char path[WB_PATH])
{
    struct wb_text text = {0};
    wb_text_append(&text, "%s%s", first, second);
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_write_text(path, &text), WB_OK);
    wb_text_release(&text);
}

/* Writes a properties file with this YAML `law`, draws a bundle with the median of each input, and
 * returns the law of its wires. */
static const struct wb_law *drawn_law(const char *law)
{
    double median[16];
    char path[WB_PATH];
    write_text("properties.yaml", properties, law, path);
    write_text("bundle.yaml", bundle, "", path);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    assert_int_equal(wb_inputs_init(&inputs, &model), WB_OK);
    assert_true(inputs.n_dimensions <= 16);
    for (int i = 0; i < inputs.n_dimensions; i++)
        median[i] = 0.5;
    assert_true(wb_inputs_apply(&inputs, median, &model, NULL));
    assert_int_equal(model.type[0].law.form, WB_LAW_LUDWIK);
    return &model.type[0].law;
}

/* An isotropic share of 0.1 lets the yield limits grow by 0.1 (3000 * 0.018 + 1000 * 0.01) =
 * 6.4 MPa up to a strain of 0.02. The part of the stress from this growth is 6.4 / 22.4: the
 * isotropic share of the mixed rule that replaces the combined one. */
static void combined_hardening_of_parts_becomes_mixed_with_the_same_isotropic_stress(void **state)
{
    (void)state;
    const struct wb_law *const law =
        drawn_law("  form: parallel\n  hardening: combined\n  isotropic_share: 0.1\n" PARTS);
    assert_false(law->is_combined);
    assert_close(law->isotropic_share, 6.4 / 22.4, 1e-12);
}

static void combined_hardening_without_growth_of_yield_limits_becomes_kinematic(void **state)
{
    (void)state;
    const struct wb_law *const law =
        drawn_law("  form: parallel\n  hardening: combined\n  isotropic_share: 0\n" PARTS);
    assert_false(law->is_combined);
    assert_close(law->isotropic_share, 0.0, 1e-12);
}

static void mixed_hardening_of_parts_is_kept(void **state)
{
    (void)state;
    const struct wb_law *const law =
        drawn_law("  form: parallel\n  hardening: mixed\n  isotropic_share: 0.3\n" PARTS);
    assert_false(law->is_combined);
    assert_close(law->isotropic_share, 0.3, 0.0);
}

static void combined_hardening_of_ludwiks_law_is_kept(void **state)
{
    (void)state;
    const struct wb_law *const law =
        drawn_law("  form: ludwik\n  hardening: combined\n  isotropic_share: 0.3\n");
    assert_true(law->is_combined);
    assert_close(law->isotropic_share, 0.3, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(combined_hardening_of_parts_becomes_mixed_with_the_same_isotropic_stress),
        cmocka_unit_test(combined_hardening_without_growth_of_yield_limits_becomes_kinematic),
        cmocka_unit_test(mixed_hardening_of_parts_is_kept),
        cmocka_unit_test(combined_hardening_of_ludwiks_law_is_kept),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
