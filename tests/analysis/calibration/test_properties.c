#include "tests/analysis/beam_data.h"

#include "analysis/calibration/properties/properties.h"
#include "tests/analysis/calibration/properties_path.h"

static struct wb_calibrate_result some_result(void)
{
    struct wb_calibrate_result result = {
        .material = beam_material(1),
        .info = beam_info(1, 0.085, 0.0),
        .first_strength_coefficient = 1.2e9,
        .first_hardening_exponent = 0.81,
        .n_samples = 3,
        .max_force = 0.1278,
        .max_deflection = 0.053,
        .deviation = {50e6, 0.06e6, 0.31, 0.011},
        .end = WB_CALIBRATE_SIZE,
        .restarted = true,
        .restart_moved = 1e-4,
        .evaluations = 120,
        .rms = 2.1e-3,
        .max_error = 6.3e-3,
        .scatter_rms = 0.031,
        .residual_scatter_rms = 0.018,
    };
    result.info.is_virtual = true;
    result.info.is_simulation = false;
    return result;
}

static void write_some(const struct wb_calibrate_result *result)
{
    struct wb_calibrate_settings settings;
    const char *const names[] = {"data/type2 \"a\"", "data\\b"};
    wb_calibrate_default_settings(&settings);
    settings.yield_point = 0.04;
    assert_int_equal(wb_properties_write(path, result, &settings, names, 2, true), WB_OK);
    assert_true(files_follow_schemas(path));
}

static void written_properties_are_read_back(void **state)
{
    (void)state;
    const struct wb_calibrate_result result = some_result();
    struct wb_properties written, read;
    write_some(&result);
    wb_properties_from_result(&result, &written);
    assert_int_equal(wb_properties_read(path, &read), WB_OK);
    assert_string_equal(read.wire, "type2");
    const double tiny = 1e-14;
    assert_close_relative(read.outer_diameter, written.outer_diameter, tiny);
    assert_close_relative(read.mass_per_length, written.mass_per_length, tiny);
    assert_close_relative(read.material.youngs_modulus, written.material.youngs_modulus, tiny);
    assert_close_relative(read.material.yield_stress, written.material.yield_stress, tiny);
    assert_close_relative(read.material.strength_coefficient, written.material.strength_coefficient,
                          tiny);
    assert_close_relative(read.material.hardening_exponent, written.material.hardening_exponent,
                          tiny);
    assert_close_relative(read.material.poissons_ratio, written.material.poissons_ratio, tiny);
    assert_int_equal(read.material.hardening, WB_HARDENING_ISOTROPIC_POWER);
    for (int k = 0; k < 4; k++)
        assert_close_relative(read.deviation[k], written.deviation[k], tiny);
    assert_close_relative(read.calibration_length, 0.085, tiny);
    assert_close_relative(read.rms, 2.1e-3, tiny);
    assert_close_relative(read.residual_scatter_rms, 0.018, tiny);
    assert_int_equal(read.n_samples, 3);
    assert_true(read.is_virtual);
    assert_false(read.is_simulation);
    assert_string_equal(read.method, "paper");
    assert_non_null(strstr(read.tool, "wirebench "));
    assert_string_equal(read.tool, written.tool);
    assert_true(wb_law_is_plain(&read.law) && wb_law_is_plain(&written.law));
    assert_close_relative(read.law.material.youngs_modulus, written.law.material.youngs_modulus,
                          tiny);
}

static void the_file_states_the_virtual_rig_and_the_settings(void **state)
{
    (void)state;
    const struct wb_calibrate_result result = some_result();
    char *text;
    write_some(&result);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    assert_non_null(strstr(text, "virtual rig"));
    assert_non_null(strstr(text, "virtual_rig: true"));
    assert_non_null(strstr(text, "yield_point: 0.04\n"));
    assert_non_null(strstr(text, "elastic_zone: 0.05\n"));
    assert_non_null(strstr(text, "stopped: the simplex became small"));
    assert_non_null(strstr(text, "data/type2 \\\"a\\\""));
    free(text);
}

static void unknown_values_stay_unknown(void **state)
{
    (void)state;
    struct wb_calibrate_result result = some_result();
    struct wb_properties read;
    for (int k = 0; k < 4; k++)
        result.deviation[k] = (double)NAN;
    result.n_samples = 1;
    write_some(&result);
    assert_int_equal(wb_properties_read(path, &read), WB_OK);
    for (int k = 0; k < 4; k++)
        assert_true(isnan(read.deviation[k]));
    assert_true(isnan(read.residual_scatter_rms));
}

static void a_file_written_by_hand_needs_only_the_properties(void **state)
{
    (void)state;
    static const char text[] = "wire: mine\nouter_diameter_mm: 2\nmass_per_length_kg_m: 0.01\n"
                               "youngs_modulus_MPa: 1000\nyield_stress_MPa: 2\n"
                               "strength_coefficient_MPa: 500\nhardening_exponent: 0.5\n"
                               "poissons_ratio: 0.4\n";
    struct wb_properties read;
    assert_int_equal(wb_file_write(path, text, sizeof text - 1), WB_OK);
    assert_int_equal(wb_properties_read(path, &read), WB_OK);
    assert_close_relative(read.material.strength_coefficient, 500e6, 1e-15);
    assert_true(isnan(read.rms) && isnan(read.calibration_length));
    assert_false(read.is_virtual);
    /* Its law is the paper's, and nothing else is known. */
    assert_true(wb_law_is_plain(&read.law));
    assert_close_relative(read.law.material.strength_coefficient, 500e6, 1e-15);
    assert_true(isnan(read.largest_curvature) && isnan(read.rigidity.value));
    assert_true(isnan(read.residual_curvature_ratio.candidates_low) && isnan(read.ludwik_misfit));
    assert_true(isnan(read.loop_energy.value) && isnan(read.moment[0].value));
    assert_int_equal(read.n_specimens, 0);
    assert_int_equal(read.n_moments, 0);
    assert_false(read.is_rule_tested || read.is_rule_supported);
}

static void energy_of_a_loop_is_read(void **state)
{
    (void)state;
    static const char text[] = "wire: mine\nouter_diameter_mm: 2\nmass_per_length_kg_m: 0.01\n"
                               "youngs_modulus_MPa: 1000\nyield_stress_MPa: 2\n"
                               "strength_coefficient_MPa: 500\nhardening_exponent: 0.5\n"
                               "poissons_ratio: 0.4\n"
                               "loop_energy_mJ_per_m: {value: 3, low: 2.5, high: 4}\n";
    struct wb_properties read;
    assert_int_equal(wb_properties_parse(text, "mine.yaml", &read, NULL), WB_OK);
    assert_close_relative(read.loop_energy.value, 3e-3, 1e-15);
    assert_close_relative(read.loop_energy.low, 2.5e-3, 1e-15);
    assert_close_relative(read.loop_energy.high, 4e-3, 1e-15);
    assert_true(isnan(read.loop_energy.candidates_low));
}

static void datasets_are_read_with_their_checksums(void **state)
{
    (void)state;
    struct wb_calibrate_result result = some_result();
    struct wb_calibrate_settings settings;
    struct wb_properties read;
    struct wb_text text = {0};
    struct wb_properties_dataset datasets[2] = {{.name = "type2-L85-S1.wbr", .is_recording = true},
                                                {.name = "computed"}};
    memset(datasets[0].sha256, 'a', WB_SHA256_TEXT - 1);
    memset(datasets[1].sha256, '0', WB_SHA256_TEXT - 1);
    wb_calibrate_default_settings(&settings);
    result.info.is_simulation = true;
    wb_properties_format(&text, &result, &settings, datasets, 2);
    assert_int_equal(wb_properties_parse(wb_text_string(&text), "origin", &read, NULL), WB_OK);
    wb_text_release(&text);
    assert_true(read.is_simulation);
    assert_int_equal(read.n_datasets, 2);
    for (int i = 0; i < 2; i++) {
        assert_string_equal(read.datasets[i].name, datasets[i].name);
        assert_string_equal(read.datasets[i].sha256, datasets[i].sha256);
        assert_int_equal(read.datasets[i].is_recording, datasets[i].is_recording);
    }
    /* The last part of a folder's path is kept; a missing checksum is unknown. */
    write_some(&result);
    assert_int_equal(wb_properties_read(path, &read), WB_OK);
    assert_int_equal(read.n_datasets, 2);
    assert_string_equal(read.datasets[0].name, "type2 \"a\"");
    assert_string_equal(read.datasets[0].sha256, "");
}

static void an_existing_file_is_kept_without_force(void **state)
{
    (void)state;
    const struct wb_calibrate_result result = some_result();
    struct wb_calibrate_settings settings;
    wb_calibrate_default_settings(&settings);
    write_some(&result);
    assert_int_equal(wb_properties_write(path, &result, &settings, NULL, 0, false), WB_ERR_EXISTS);
    assert_message("--force");
}

static void errors_name_file_line_and_key(void **state)
{
    (void)state;
    struct wb_properties read;
    static const char unknown[] = "wire: mine\ncolour: red\n";
    assert_int_equal(wb_file_write(path, unknown, sizeof unknown - 1), WB_OK);
    assert_int_equal(wb_properties_read(path, &read), WB_ERR_FORMAT);
    assert_message("properties.yaml:2");
    assert_message("colour");
    static const char negative[] = "wire: mine\nouter_diameter_mm: 2\nmass_per_length_kg_m: 0.01\n"
                                   "youngs_modulus_MPa: -5\n";
    assert_int_equal(wb_file_write(path, negative, sizeof negative - 1), WB_OK);
    assert_int_equal(wb_properties_read(path, &read), WB_ERR_FORMAT);
    assert_message("youngs_modulus_MPa");
    assert_int_not_equal(wb_properties_read("/nonexistent/p.yaml", &read), WB_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(written_properties_are_read_back),
        cmocka_unit_test(the_file_states_the_virtual_rig_and_the_settings),
        cmocka_unit_test(unknown_values_stay_unknown),
        cmocka_unit_test(a_file_written_by_hand_needs_only_the_properties),
        cmocka_unit_test(energy_of_a_loop_is_read),
        cmocka_unit_test(datasets_are_read_with_their_checksums),
        cmocka_unit_test(an_existing_file_is_kept_without_force),
        cmocka_unit_test(errors_name_file_line_and_key),
    };
    return cmocka_run_group_tests(tests, make_path, remove_folder);
}
