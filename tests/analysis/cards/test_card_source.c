/* Source of a card: files are recognised by their content, and the card describes them. */
#include <stdlib.h>

#include "base/file.h"
#include "base/hash.h"
#include "fe/model/wire.h"
#include "tests/analysis/cards/wires.h"
#include "tests/own_folder.h"

#define WIRE "name: test\nconductor_diameter_mm: 0.8\nouter_diameter_mm: 1.2\ndensity_g_cm3: 4\n"
#define CALIBRATION "calibration:\n  length_mm: 85\n  samples: 4\n"
#define DATASET                                                                                    \
    "  datasets:\n    - folder: data/long--name/type1-S1\n      force_deflection_sha256: "         \
    "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff\n"
#define SUPPORTED "hardening_rule: {chosen: parts, tested: true, supported: true}\n"

/* The header of every card, in one text. */
static struct wb_text header_of(const struct wb_card_source *source)
{
    struct wb_text text = {0};
    wb_card_source_append(source, "Some card", "## ", &text);
    return text;
}

#define assert_says(source, part)                                                                  \
    do {                                                                                           \
        struct wb_text words_ = header_of(source);                                                 \
        if (!strstr(wb_text_string(&words_), (part)))                                              \
            fail_msg("'%s' does not say '%s'", wb_text_string(&words_), (part));                   \
        wb_text_release(&words_);                                                                  \
    } while (0)

static void wire_files_and_properties_files_are_recognised(void **state)
{
    (void)state;
    const struct wb_card_source wire = source_of(
        WIRE "properties:\n  source: a table\n  youngs_modulus_MPa: 5000\n  poissons_ratio: 0.39\n"
             "  yield_stress_MPa: 5\n  strength_coefficient_MPa: 900\n  hardening_exponent: 0.8\n");
    const struct wb_card_source properties = source_of(PROPERTIES);
    assert_true(wire.is_wire_file && !properties.is_wire_file);
    assert_string_equal(wire.properties.wire, "test");
    assert_string_equal(wire.file, "test.yaml");
    assert_close_relative(wire.properties.mass_per_length, 4e3 * M_PI * 0.36e-6, 1e-12);
    assert_close_relative(wire.properties.law.material.youngs_modulus,
                          properties.properties.law.material.youngs_modulus, 1e-15);
    assert_says(&wire, "Wire file: test.yaml, sha256 ");
    assert_says(&wire, "a table");
    assert_says(&wire, "LOADING ONLY");
    assert_says(&properties, "Properties: test.yaml, sha256 ");
}

static void the_checksum_is_that_of_the_file(void **state)
{
    (void)state;
    char path[WB_PATH], hex[WB_SHA256_TEXT];
    struct wb_card_source source;
    assert_int_equal(wb_file_join(path, folder, "p.yaml"), WB_OK);
    assert_int_equal(wb_file_write(path, PROPERTIES, strlen(PROPERTIES)), WB_OK);
    assert_int_equal(wb_card_source_read(&source, path), WB_OK);
    assert_int_equal(wb_hash_file(path, hex), WB_OK);
    assert_string_equal(source.sha256, hex);
    assert_says(&source, hex);
}

static void other_files_are_rejected_with_the_expected_ones(void **state)
{
    (void)state;
    struct wb_card_source source;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"name: pvc\nyoungs_modulus_MPa: 3\n", "expected a wire file"},
        {"- 1\n", "expected a wire file"},
        {WIRE, "properties: wire test has none"},
        {PROPERTIES "colour: red\n", "a.yaml:9"},
        {PROPERTIES "law: {form: ludwik, hardening: kinematic, isotropic_share: 3}\n",
         "isotropic_share"},
    };
    keep_messages();
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        assert_int_not_equal(wb_card_source_parse(&source, cases[i].text, "folder/a.yaml", NULL),
                             WB_OK);
        assert_message(cases[i].message);
        assert_message("a.yaml");
    }
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, "r.wbr"), WB_OK);
    assert_int_equal(wb_file_write(path, "SQLite format 3\0\1\2", 18), WB_OK);
    assert_int_equal(wb_card_source_read(&source, path), WB_ERR_FORMAT);
    assert_message("without --to");
    release_messages();
}

static void virtual_and_simulated_data_are_stated_in_the_first_line(void **state)
{
    (void)state;
    const struct wb_card_settings settings = card_defaults();
    static const struct {
        const char *text, *words;
    } cases[] = {
        {PROPERTIES CALIBRATION "  virtual_rig: true\n", "MADE OF VIRTUAL DATA"},
        {PROPERTIES CALIBRATION "  simulation: true\n", "MADE OF SIMULATED DATA"},
        {PROPERTIES CALIBRATION "  virtual_rig: false\n", NULL},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        const struct wb_card_source source = source_of(cases[i].text);
        for (int k = 0; k < WB_CARD_KINDS; k++) {
            struct wb_text card = card_of(wb_card_kinds[k].name, &source, &settings);
            char *const end = strchr(card.bytes, '\n');
            *end = '\0';
            assert_true(cases[i].words ? strstr(card.bytes, cases[i].words) != NULL
                                       : strstr(card.bytes, "MADE OF") == NULL);
            wb_text_release(&card);
        }
    }
}

static void a_card_states_tests_datasets_and_range(void **state)
{
    (void)state;
    const struct wb_card_source source =
        source_of(PROPERTIES KINEMATIC
                  "method: cycle\nlargest_curvature_1_m: 25\n" SUPPORTED CALIBRATION DATASET);
    assert_true(wb_card_source_has_unloading(&source));
    assert_close(wb_card_source_curvature(&source), 25.0, 1e-12);
    assert_says(&source, "whole cycles, free length 85 mm, 4 samples");
    assert_says(&source, "0 to 25 1/m as tested (0.015 of strain at the outer fibre)");
    assert_says(&source, "kinematic, supported by loading and unloading");
    assert_says(&source, "type1-S1, force_deflection.csv sha256");
    assert_says(&source, "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff");
}

static void no_line_ends_a_comment_of_xml(void **state)
{
    (void)state;
    const struct wb_card_source source =
        source_of("wire: a--->b---\nouter_diameter_mm: 1.2\n"
                  "mass_per_length_kg_m: 0.004\n" LUDWIK_NUMBERS CALIBRATION DATASET);
    struct wb_text words = header_of(&source);
    assert_null(strstr(wb_text_string(&words), "--"));
    assert_non_null(strstr(wb_text_string(&words), "a- - ->b- - -"));
    wb_text_release(&words);
}

static void every_line_has_the_prefix_and_fits(void **state)
{
    (void)state;
    const struct wb_card_source source = source_of(PROPERTIES MIXED CALIBRATION DATASET);
    struct wb_text words = header_of(&source);
    for (const char *line = words.bytes; *line; line = strchr(line, '\n') + 1) {
        assert_int_equal(strncmp(line, "## ", 3), 0);
        assert_true(strcspn(line, "\n") < 200);
    }
    wb_text_release(&words);
}

static void the_interval_of_ei_is_students(void **state)
{
    (void)state;
    const struct wb_card_source one = source_of(PROPERTIES);
    const struct wb_card_source four = source_of(
        PROPERTIES "deviations: {youngs_modulus_MPa: 100, yield_stress_MPa: 1}\n" CALIBRATION);
    const struct wb_card_source given =
        source_of(PROPERTIES "flexural_rigidity_N_mm2: {value: 500, low: 480, high: 520}\n");
    const double I = M_PI * pow(1.2e-3, 4.0) / 64.0;
    assert_close_relative(wb_card_source_rigidity(&one).value, 5e9 * I, 1e-12);
    assert_true(isnan(wb_card_source_rigidity(&one).low));
    /* t of 95 % and 3 degrees of freedom: 3.18245. */
    assert_close_relative(wb_card_source_rigidity(&four).low, (5e9 - 3.18245 * 100e6) * I, 1e-5);
    assert_close_relative(wb_card_source_rigidity(&four).high, (5e9 + 3.18245 * 100e6) * I, 1e-5);
    assert_close_relative(wb_card_source_rigidity(&given).low, 480e-6, 1e-12);
    assert_says(&given, "Interval of 95 % of EI: 0.00048 to 0.00052 N m2");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wire_files_and_properties_files_are_recognised),
        cmocka_unit_test(the_checksum_is_that_of_the_file),
        cmocka_unit_test(other_files_are_rejected_with_the_expected_ones),
        cmocka_unit_test(virtual_and_simulated_data_are_stated_in_the_first_line),
        cmocka_unit_test(a_card_states_tests_datasets_and_range),
        cmocka_unit_test(no_line_ends_a_comment_of_xml),
        cmocka_unit_test(every_line_has_the_prefix_and_fits),
        cmocka_unit_test(the_interval_of_ei_is_students),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
