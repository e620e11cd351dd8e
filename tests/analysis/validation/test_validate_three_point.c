/* Validation on three-point bending tests of wires whose laws are known. */
#include "analysis/validation/validate_three_point.h"

#include <stdlib.h>

#include "base/file.h"
#include "base/units.h"
#include "tests/analysis/three_point_data.h"
#include "tests/own_folder.h"

enum {
    MOST = 6
};

static struct wb_dataset datasets[MOST];
static struct wb_validate_three_point result;
static struct wb_three_point_calibrate_settings settings;

static int begin(void **state)
{
    (void)state;
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &settings.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &settings.fit);
    return 0;
}

static struct wb_properties properties_of(const struct three_point_made *made)
{
    struct wb_properties p = {
        .wire = "type2",
        .outer_diameter = test_wire_type(2).diameter,
        .material = three_point_material(made),
        .stiffness_deviation = (double)NAN,
        .largest_curvature = (double)NAN,
        .is_rule_tested = true,
    };
    wb_law_init_ludwik(&p.law, &p.material);
    return p;
}

/* Validates the first n datasets, and releases them. */
static enum wb_status validate(const struct wb_properties *properties, int n, struct wb_reason *why)
{
    const struct wb_dataset *pointers[MOST];
    for (int i = 0; i < n; i++)
        pointers[i] = &datasets[i];
    const enum wb_status status =
        wb_validate_three_point_run(&result, properties, pointers, n, &settings, why);
    for (int i = 0; i < n; i++)
        wb_dataset_release(&datasets[i]);
    return status;
}

static const struct three_point_made plain = {
    .modulus_factor = 1.0, .friction = 0.3, .nose_radius = 2e-3};

static void true_law_predicts_loading_and_unloading(void **state)
{
    (void)state;
    struct three_point_made made = plain;
    made.compliance = 0.05e-3;
    made.contact = 0.4e-3;
    made.zero = 0.02;
    made.noise = 2e-3;
    made.with_unloading = true;
    const struct wb_properties properties = properties_of(&made);
    three_point_make(&datasets[0], &made, "");
    assert_int_equal(validate(&properties, 1, NULL), WB_OK);
    print_message("loading %.2g, unloading %.2g, left %.3f of %.3f mm, elastic %.2g\n",
                  result.loading.rms, result.unloading.rms, result.residual_computed / WB_MM,
                  result.residual_measured / WB_MM, result.elastic_rms);
    assert_true(result.loading.rms < 2e-3);
    assert_true(result.unloading.rms < 5e-3);
    assert_true(result.unloading_rms_of_tests < 5e-3);
    assert_close(result.residual_computed, result.residual_measured, 0.02e-3);
    assert_true(result.residual_measured > 0.5e-3);
    assert_close(result.tests[0].first_contact, made.contact, 0.01e-3);
    assert_true(result.elastic_rms > 0.3);
    assert_false(result.is_rule_untested);
    assert_true(isnan(result.bench_rms[0]) && isnan(result.bench_rms[2])); /* known exactly */
    assert_true(isnan(result.expected.rms));                               /* of a single test */
    wb_validate_three_point_release(&result);
}

static void wrong_law_is_detected_on_each_part(void **state)
{
    (void)state;
    struct three_point_made made = plain, soft = plain;
    made.with_unloading = true;
    soft.modulus_factor = 0.8;
    struct wb_properties properties = properties_of(&soft);
    properties.is_rule_tested = false;
    properties.largest_curvature = 10.0;
    three_point_make(&datasets[0], &made, "");
    assert_int_equal(validate(&properties, 1, NULL), WB_OK);
    assert_close(result.loading.rms, 0.2 * 0.7, 0.05);
    for (int k = 10; k < WB_VALIDATE_THREE_POINT_GRID; k += 10)
        assert_close_relative(result.loading.computed[k], 0.8 * result.loading.measured[k], 0.02);
    assert_true(result.unloading.rms > 0.03);
    assert_true(result.is_rule_untested && result.is_beyond);
    wb_validate_three_point_release(&result);
}

/* Stiffnesses of 0.9, 1 and 1.1. The error of a law of 1 is explained by this scatter, that of a
 * law of 1.6 is not. */
static void expected_error_follows_from_the_scatter(void **state)
{
    (void)state;
    for (int wrong = 0; wrong < 2; wrong++) {
        struct three_point_made made = plain;
        for (int i = 0; i < 3; i++) {
            made.modulus_factor = 0.9 + 0.1 * i;
            three_point_make(&datasets[i], &made, "");
        }
        made.modulus_factor = wrong ? 1.6 : 1.0;
        const struct wb_properties properties = properties_of(&made);
        assert_int_equal(validate(&properties, 3, NULL), WB_OK);
        assert_false(result.is_by_series);
        assert_int_equal(result.expected.degrees, 2);
        assert_close(result.expected.deviation, 0.1, wrong ? 0.05 : 0.005);
        assert_int_equal(result.loading.rms > result.expected.rms_95, wrong);
        for (int i = 0; i < 3; i++)
            assert_close(result.tests[i].first_contact, 0.0, 0.02e-3);
        wb_validate_three_point_release(&result);
    }
}

static void with_several_series_their_means_are_the_unit(void **state)
{
    (void)state;
    struct three_point_made made = plain;
    for (int i = 0; i < 4; i++) {
        made.modulus_factor = i < 2 ? 1.1 : 0.9;
        three_point_make(&datasets[i], &made, i < 2 ? "1" : "1b");
    }
    struct wb_properties properties = properties_of(&plain);
    assert_int_equal(validate(&properties, 4, NULL), WB_OK);
    assert_true(result.is_by_series);
    assert_int_equal(result.expected.degrees, 1);
    assert_close(result.expected.deviation, 0.2 / sqrt(2.0), 0.01);
    wb_validate_three_point_release(&result);
    /* If the calibration has several series, the series is the unit, even for tests of one
     * series. */
    properties.n_samples = 6;
    properties.n_series = 3;
    properties.stiffness_deviation = 0.2;
    three_point_make(&datasets[0], &plain, "1");
    three_point_make(&datasets[1], &plain, "1");
    assert_int_equal(validate(&properties, 2, NULL), WB_OK);
    assert_int_equal(result.expected.degrees, 2);
    assert_close(result.expected.deviation, 0.2, 1e-12);
    wb_validate_three_point_release(&result);
}

static void an_unknown_bench_is_varied(void **state)
{
    (void)state;
    struct wb_properties properties = properties_of(&plain);
    three_point_make(&datasets[0], &plain, "");
    datasets[0].info.machine.friction.known = false;
    assert_int_equal(validate(&properties, 1, NULL), WB_OK);
    assert_close(result.bench.friction, 0.3, 1e-12);
    assert_true(result.bench_rms[0] > 10.0 * result.loading.rms);
    assert_true(result.bench_rms[1] > 10.0 * result.loading.rms);
    assert_true(isnan(result.bench_rms[2]));
    wb_validate_three_point_release(&result);
}

/* Two wires, bowed up and down; a straight wire has another curve. */
static void bows_of_the_specimens_are_used(void **state)
{
    (void)state;
    const struct wb_properties properties = properties_of(&plain);
    double straight = 0.0;
    for (int known = 0; known < 2; known++) {
        for (int i = 0; i < 2; i++) {
            struct three_point_made made = plain;
            made.bow = i == 0 ? 0.8e-3 : 0.3e-3;
            made.with_unloading = true;
            three_point_make(&datasets[i], &made, "");
            datasets[i].info.piece.natural_bow =
                (struct wb_band){known == 1, made.bow, made.bow, made.bow};
        }
        assert_int_equal(validate(&properties, 2, NULL), WB_OK);
        print_message("loading %.2g, unloading %.2g\n", result.loading.rms, result.unloading.rms);
        if (known == 0)
            straight = result.loading.rms;
        for (int i = 0; i < 2 && known == 1; i++)
            assert_close(result.tests[i].rms, 0.0, 2e-3);
        assert_false(result.tests[0].is_bow_searched);
        assert_close(result.tests[1].bow, known ? 0.3e-3 : 0.0, 1e-12);
        if (known == 1) {
            assert_true(result.loading.rms < 2e-3 && result.loading.rms < 0.2 * straight);
            assert_true(result.unloading.rms < 5e-3);
        }
        wb_validate_three_point_release(&result);
    }
}

static void bow_with_a_range_is_found(void **state)
{
    (void)state;
    const struct wb_properties properties = properties_of(&plain);
    for (int by_settings = 0; by_settings < 2; by_settings++) {
        struct three_point_made made = plain;
        made.bow = 0.6e-3;
        three_point_make(&datasets[0], &made, "");
        if (by_settings)
            settings.fit.bow_prior = 0.05;
        else
            datasets[0].info.piece.natural_bow = (struct wb_band){true, 0.0, -2e-3, 2e-3};
        assert_int_equal(validate(&properties, 1, NULL), WB_OK);
        assert_true(result.tests[0].is_bow_searched);
        assert_close(result.tests[0].bow, made.bow, 0.05e-3);
        assert_true(result.loading.rms < 2e-3);
        wb_validate_three_point_release(&result);
    }
}

static void settings_of_the_calibration_are_used(void **state)
{
    (void)state;
    const struct wb_properties properties = properties_of(&plain);
    settings.data.seating = 0.03;
    settings.data.usable = 3e-3;
    three_point_make(&datasets[0], &plain, "");
    assert_int_equal(validate(&properties, 1, NULL), WB_OK);
    assert_true(result.loading.deflection[0] >= 0.03 * three_point_span - 0.01e-3);
    assert_close(result.loading.deflection[WB_VALIDATE_THREE_POINT_GRID - 1], 3e-3, 0.02e-3);
    wb_validate_three_point_release(&result);
}

static void tests_that_cannot_be_validated_are_rejected(void **state)
{
    (void)state;
    struct wb_properties properties = properties_of(&plain);
    struct wb_reason why;
    properties.outer_diameter *= 2.0;
    three_point_make(&datasets[0], &plain, "");
    assert_int_equal(validate(&properties, 1, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "mm across"));
    properties.outer_diameter *= 0.5;
    three_point_make(&datasets[0], &plain, "");
    for (size_t i = 0; i < datasets[0].n_rows; i++)
        datasets[0].rows[i].force = 0.0;
    assert_int_equal(validate(&properties, 1, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "first contact"));
}

static void tables_and_numbers_are_those_of_the_result(void **state)
{
    (void)state;
    struct three_point_made made = plain;
    struct wb_text scores = {0};
    char path[WB_PATH], *text;
    size_t size;
    made.with_unloading = true;
    const struct wb_properties properties = properties_of(&plain);
    three_point_make(&datasets[0], &made, "");
    assert_int_equal(validate(&properties, 1, NULL), WB_OK);
    assert_int_equal(wb_file_join(path, folder, "loading.csv"), WB_OK);
    assert_int_equal(wb_validate_three_point_write_csv(&result, false, path), WB_OK);
    assert_int_equal(wb_file_read(path, &text, &size), WB_OK);
    assert_non_null(strstr(text, "wire type2, L = 20 mm, 1 sample,"));
    int lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, 2 + WB_VALIDATE_THREE_POINT_GRID);
    free(text);
    wb_validate_three_point_put_scores(&scores, &result);
    assert_non_null(strstr(wb_text_string(&scores), "type2,20,residual_deflection,"));
    wb_text_release(&scores);
    struct wb_json *const json = wb_json_create();
    double number;
    wb_validate_three_point_put_json(json, &result);
    assert_true(wb_json_number(wb_json_get(wb_json_get(json, "unloading"), "rms"), &number));
    assert_close(number, result.unloading.rms, 1e-12);
    assert_true(wb_json_number(
        wb_json_get(wb_json_item(wb_json_get(json, "tests"), 0), "unloading_rms"), &number));
    wb_json_destroy(json);
    wb_validate_three_point_release(&result);
}

static void expected_error_is_of_both_groups(void **state)
{
    (void)state;
    const struct wb_expected_group here = {2, 0.1}, calibration = {3, 0.2}, none = {0, (double)NAN};
    struct wb_expected e = wb_expected_find(&here, &calibration, 0.5, 0.01);
    assert_int_equal(e.degrees, 3);
    assert_close(e.deviation, sqrt((0.01 + 2.0 * 0.04) / 3.0), 1e-12);
    assert_close(e.rms, 0.5 * e.deviation * sqrt(1.0 / 2.0 + 1.0 / 3.0), 1e-12);
    assert_close(e.rms_95 / e.rms, 3.182446, 1e-5); /* Student's t, 0.975, three degrees */
    assert_close(e.share, 1.0, 0.0);
    e = wb_expected_find(&none, &none, 0.5, 0.01);
    assert_true(e.degrees == 0 && isnan(e.rms_95));
}

#define TEST(name) cmocka_unit_test_setup(name, begin)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(true_law_predicts_loading_and_unloading),
        TEST(wrong_law_is_detected_on_each_part),
        TEST(expected_error_follows_from_the_scatter),
        TEST(with_several_series_their_means_are_the_unit),
        TEST(an_unknown_bench_is_varied),
        TEST(bows_of_the_specimens_are_used),
        TEST(bow_with_a_range_is_found),
        TEST(settings_of_the_calibration_are_used),
        TEST(tests_that_cannot_be_validated_are_rejected),
        TEST(tables_and_numbers_are_those_of_the_result),
        TEST(expected_error_is_of_both_groups),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
