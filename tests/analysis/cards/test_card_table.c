/* Tables are parsed: JSON and CSV have the same numbers, equal to those of the properties. */
#include <stdlib.h>

#include "analysis/calibration/law/bending.h"
#include "analysis/cards/card_curve.h"
#include "base/json.h"
#include "tests/analysis/cards/wires.h"

/* EI of the parts is 5000 MPa times I. The moments below differ from those of the law, to test that
 * the band is relative. */
#define MEASURED                                                                                   \
    PROPERTIES KINEMATIC                                                                           \
        "method: cycle\nlargest_curvature_1_m: 20\n"                                               \
        "flexural_rigidity_N_mm2: {value: 500, low: 450, high: 560, candidates_low: 400, "         \
        "candidates_high: 600}\n"                                                                  \
        "residual_curvature_ratio: {value: 0.3, low: 0.28, high: 0.33}\n"                          \
        "moment_curvature:\n"                                                                      \
        "  - {curvature_1_m: 4, moment_N_mm: 2, low: 1.9, high: 2.2}\n"                            \
        "  - {curvature_1_m: 20, moment_N_mm: 5, low: 4.9, high: 5.2}\n"                           \
        "hardening_rule: {chosen: parts, tested: true, supported: true}\n"                         \
        "calibration:\n  length_mm: 85\n  samples: 3\n  datasets:\n    - folder: a/b\n"

static struct wb_json *json_of(const struct wb_card_source *source)
{
    const struct wb_card_settings settings = card_defaults();
    struct wb_text text = card_of("table", source, &settings);
    struct wb_json *root;
    assert_int_equal(wb_json_parse(&root, wb_text_string(&text), "card"), WB_OK);
    wb_text_release(&text);
    return root;
}

static double number_at(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    (void)wb_json_get_number(object, key, &value);
    return value;
}

static double item_at(const struct wb_json *object, const char *key, int k)
{
    double value = (double)NAN;
    (void)wb_json_number(wb_json_item(wb_json_get(object, key), (size_t)k), &value);
    return value;
}

static void json_has_the_values_of_the_properties(void **state)
{
    (void)state;
    const struct wb_card_source source = source_of(MEASURED);
    struct wb_json *const root = json_of(&source);
    const struct wb_json *const rigidity = wb_json_get(root, "flexural_rigidity_N_m2");
    const struct wb_json *const law = wb_json_get(root, "law");
    const struct wb_json *const parts = wb_json_get(law, "parts");
    const char *text;
    bool flag = true;
    assert_true(wb_json_get_text(root, "wire", &text));
    assert_string_equal(text, "test");
    assert_close_relative(number_at(root, "outer_diameter_m"), 1.2e-3, 1e-15);
    assert_close_relative(number_at(root, "mass_per_length_kg_m"), 0.004, 1e-15);
    assert_close_relative(number_at(rigidity, "value"), 500e-6, 1e-15);
    assert_close_relative(number_at(rigidity, "low"), 450e-6, 1e-15);
    assert_close_relative(number_at(rigidity, "candidates_high"), 600e-6, 1e-15);
    assert_close_relative(number_at(wb_json_get(root, "residual_curvature_ratio"), "high"), 0.33,
                          1e-15);
    assert_int_equal(wb_json_length(parts), 4);
    assert_close_relative(number_at(wb_json_item(parts, 1), "modulus_Pa"), 1500e6, 1e-15);
    assert_close_relative(number_at(wb_json_item(parts, 1), "yield_strain"), 0.0015, 1e-15);
    assert_true(isnan(number_at(wb_json_item(parts, 3), "yield_strain")));
    assert_true(wb_json_get_boolean(root, "loading_only", &flag) && !flag);
    assert_close_relative(number_at(wb_json_get(root, "test"), "length_m"), 0.085, 1e-15);
    assert_true(wb_json_get_text(wb_json_get(root, "source"), "sha256", &text));
    assert_string_equal(text, source.sha256);
    assert_true(wb_json_get_text(wb_json_item(wb_json_get(root, "datasets"), 0), "name", &text));
    assert_string_equal(text, "b");
    wb_json_destroy(root);
}

static void moments_come_from_the_law_and_the_band_from_the_calibration(void **state)
{
    (void)state;
    const struct wb_card_source source = source_of(MEASURED);
    struct wb_json *const root = json_of(&source);
    const struct wb_json *const curve = wb_json_get(root, "moment_curvature");
    static const struct {
        double curvature, low, high; /* ratios */
    } points[] = {{4.0, 0.95, 1.1}, {12.0, 0.965, 1.07}, {20.0, 0.98, 1.04}, {2.0, 0.925, 1.11}};
    for (size_t i = 0; i < WB_COUNT(points); i++) {
        const double kappa = points[i].curvature;
        const int k = (int)lround(kappa * WB_CARD_CURVE / 20.0) - 1;
        double M;
        assert_int_equal(wb_bending_moments(&source.properties.law, 1.2e-3, 1, &kappa, &M), WB_OK);
        assert_close_relative(item_at(curve, "curvature_1_m", k), kappa, 1e-12);
        assert_close_relative(item_at(curve, "moment_N_m", k), M, 1e-9);
        assert_close_relative(item_at(curve, "low_N_m", k), points[i].low * M, 1e-9);
        assert_close_relative(item_at(curve, "high_N_m", k), points[i].high * M, 1e-9);
        assert_close_relative(item_at(curve, "secant_flexural_rigidity_N_m2", k), M / kappa, 1e-9);
    }
    wb_json_destroy(root);
}

static void csv_has_the_numbers_of_json(void **state)
{
    (void)state;
    static const char *const texts[] = {MEASURED, PROPERTIES};
    static const char *const columns[] = {"curvature_1_m",
                                          "moment_N_m",
                                          "low_N_m",
                                          "high_N_m",
                                          "candidates_low_N_m",
                                          "candidates_high_N_m",
                                          "secant_flexural_rigidity_N_m2"};
    const struct wb_card_settings settings = card_defaults();
    for (size_t i = 0; i < WB_COUNT(texts); i++) {
        const struct wb_card_source source = source_of(texts[i]);
        struct wb_json *const root = json_of(&source);
        const struct wb_json *const curve = wb_json_get(root, "moment_curvature");
        struct wb_text text = card_of("table-csv", &source, &settings);
        const char *at = strstr(wb_text_string(&text), "\ncurvature_1_m,");
        assert_non_null(at);
        at = strchr(at + 1, '\n') + 1;
        for (int k = 0; k < WB_CARD_CURVE; k++) {
            for (size_t c = 0; c < WB_COUNT(columns); c++) {
                char *end;
                const double value = strtod(at, &end), expected = item_at(curve, columns[c], k);
                assert_true(end == at ? isnan(expected)
                                      : fabs(value - expected) <= 1e-15 * fabs(value));
                assert_int_equal(*end, c + 1 < WB_COUNT(columns) ? ',' : '\n');
                at = end + 1;
            }
        }
        assert_int_equal(*at, '\0');
        wb_text_release(&text);
        wb_json_destroy(root);
    }
}

static void the_secant_falls_from_ei_and_has_its_band(void **state)
{
    (void)state;
    const struct wb_card_source source = source_of(MEASURED);
    double virgin, bent, low, high, M;
    const double kappa = 12.0;
    assert_int_equal(wb_card_curve_secant(&source, 0.0, &virgin, &low, &high), WB_OK);
    assert_close_relative(virgin, 500e-6, 1e-15);
    assert_close_relative(low, 450e-6, 1e-12);
    assert_int_equal(wb_bending_moments(&source.properties.law, 1.2e-3, 1, &kappa, &M), WB_OK);
    assert_int_equal(wb_card_curve_secant(&source, kappa, &bent, &low, &high), WB_OK);
    assert_close_relative(bent, M / kappa, 1e-12);
    assert_close_relative(high, 1.07 * bent, 1e-9);
    assert_true(bent < 0.5 * virgin);
}

static void the_same_file_gives_the_same_bytes(void **state)
{
    (void)state;
    const struct wb_card_source source = source_of(MEASURED);
    const struct wb_card_settings settings = card_defaults();
    for (int k = 0; k < WB_CARD_KINDS; k++) {
        struct wb_text a = card_of(wb_card_kinds[k].name, &source, &settings);
        struct wb_text b = card_of(wb_card_kinds[k].name, &source, &settings);
        assert_string_equal(wb_text_string(&a), wb_text_string(&b));
        wb_text_release(&a);
        wb_text_release(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_has_the_values_of_the_properties),
        cmocka_unit_test(moments_come_from_the_law_and_the_band_from_the_calibration),
        cmocka_unit_test(csv_has_the_numbers_of_json),
        cmocka_unit_test(the_secant_falls_from_ei_and_has_its_band),
        cmocka_unit_test(the_same_file_gives_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
