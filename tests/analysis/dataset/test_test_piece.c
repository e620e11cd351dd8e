#include "analysis/dataset/test_piece_private.h"

#include <stdlib.h>

#include "tests/messages.h"

static void a_bent_wire_needs_no_wire_file(void **state)
{
    (void)state;
    struct wb_test_piece piece;
    assert_int_equal(wb_test_piece_parse("wire: 30 AWG insulated\nouter_diameter_mm: 0.8\n"
                                         "sample: 2\nseries: 1b\nusable_travel_mm: [4, 10]\n",
                                         "s.yaml", WB_TEST_THREE_POINT, &piece, NULL),
                     WB_OK);
    assert_string_equal(piece.wire, "30 AWG insulated");
    assert_string_equal(piece.series, "1b");
    assert_int_equal(piece.sample, 2);
    assert_close_relative(piece.outer_diameter, 0.8e-3, 1e-15);
    assert_close_relative(piece.usable_travel.least, 4e-3, 1e-15);
    assert_close_relative(piece.usable_travel.value, 7e-3, 1e-15);
    assert_true(piece.mass_per_length == 0.0);
    assert_true(isnan(piece.length) && isnan(piece.area));
}

static void a_known_wire_gives_diameter_and_mass(void **state)
{
    (void)state;
    struct wb_test_piece piece;
    assert_int_equal(wb_test_piece_parse("wire: type1\nlength_mm: 85\nsample: 1\n"
                                         "markers_mm: [0, 85]\nmarker_offset_mm: 1\n",
                                         "s.yaml", WB_TEST_CANTILEVER, &piece, NULL),
                     WB_OK);
    assert_close_relative(piece.outer_diameter, 1.1e-3, 1e-15);
    assert_close_relative(piece.mass_per_length, 4060.0 * 0.25 * M_PI * 1.1e-3 * 1.1e-3, 1e-12);
    assert_close_relative(piece.length, 0.085, 1e-15);
    assert_close(piece.poissons_ratio, 0.39, 0.0);
}

static void areas_follow_from_what_is_given(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double mm2;
    } cases[] = {
        {"constituent: conductor\narea_mm2: 0.326\n", 0.326},
        {"constituent: conductor\nstrands: 60\nstrand_diameter_mm: 0.08\n",
         60 * M_PI * 0.08 * 0.08 / 4},
        {"constituent: jacket\nouter_diameter_mm: 1.7\ninner_diameter_mm: 0.8\n",
         M_PI * (1.7 * 1.7 - 0.8 * 0.8) / 4},
        {"constituent: tape\nwidth_mm: 12\nthickness_mm: 0.1\n", 1.2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        struct wb_test_piece piece;
        snprintf(text, sizeof text, "wire: w\nsample: 1\n%s", cases[i].text);
        assert_int_equal(wb_test_piece_parse(text, "s.yaml", WB_TEST_TENSILE, &piece, NULL), WB_OK);
        assert_close_relative(piece.area, cases[i].mm2 * 1e-6, 1e-12);
    }
}

static void bad_files_are_refused_with_the_reason(void **state)
{
    (void)state;
    static const struct {
        enum wb_test_kind kind;
        const char *text, *expected;
    } cases[] = {
        {WB_TEST_THREE_POINT, "wire: nothing-of-that-name\nsample: 1\n", "s.yaml:1: wire"},
        {WB_TEST_THREE_POINT, "wire: w\nouter_diameter_mm: 0.8\n", "sample: this key is missing"},
        {WB_TEST_THREE_POINT, "wire: w\nouter_diameter_mm: 0.8\nsample: 1\narea_mm2: 3\n",
         "s.yaml:4: area_mm2: only a tensile test has this"},
        {WB_TEST_CANTILEVER, "wire: type1\nsample: 1\n", "length_mm: this key is missing"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\narea_mm2: 3\n", "constituent: this key is missing"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\nconstituent: tape\n", "expected the area"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\nconstituent: tape\nwidth_mm: 3\n",
         "width_mm and thickness_mm together"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\nconstituent: conductor\nstrands: 3\n",
         "strands and strand_diameter_mm together"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\nconstituent: tape\nwidth_mm: 3\narea_mm2: 1\n",
         "expected the area"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\nconstituent: jacket\ninner_diameter_mm: 3\n",
         "s.yaml:4: inner_diameter_mm: expected less than outer_diameter_mm, which is missing"},
        {WB_TEST_THREE_POINT, "wire: w\nouter_diameter_mm: 1\nsample: 1\nnatural_bow_mm: [1, 0]",
         "s.yaml:4: natural_bow_mm: expected the least first"},
        {WB_TEST_TENSILE, "wire: w\nsample: 1\nconstituent: tape\narea_mm2: 1\nnatural_bow_mm: 1",
         "natural_bow_mm: only specimens of three-point bending have one"},
        {WB_TEST_THREE_POINT, "wire: w\nouter_diameter_mm: 1\nsample: 1\nusable_travel_mm: [4, 3]",
         "s.yaml:4: usable_travel_mm: expected the least first"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_test_piece piece;
        struct wb_reason why = {{0}};
        assert_int_not_equal(
            wb_test_piece_parse(cases[i].text, "s.yaml", cases[i].kind, &piece, &why), WB_OK);
        if (!strstr(why.text, cases[i].expected))
            fail_msg("'%s' does not say '%s'", why.text, cases[i].expected);
    }
}

static void a_document_gives_the_same_piece_back(void **state)
{
    (void)state;
    struct wb_test_piece piece, back;
    struct wb_json *const document = wb_json_create();
    assert_int_equal(
        wb_test_piece_parse("wire: w\nsample: 1\nseries: b\nmass_per_length_g_m: 2.1\n"
                            "constituent: jacket\nouter_diameter_mm: 1.7\ninner_diameter_mm: 0.8\n"
                            "length_mm: 120\nusable_travel_mm: 4\n",
                            "s.yaml", WB_TEST_TENSILE, &piece, NULL),
        WB_OK);
    wb_test_piece_set_json(&piece, document);
    assert_int_equal(wb_test_piece_get_json(&back, document, "d", NULL), WB_OK);
    assert_string_equal(back.series, "b");
    assert_int_equal(back.constituent, WB_JACKET);
    assert_close_relative(back.area, piece.area, 1e-13);
    assert_close_relative(back.length, 0.12, 1e-13);
    assert_close_relative(back.mass_per_length, 2.1e-3, 1e-13);
    assert_close_relative(back.usable_travel.value, 4e-3, 1e-13);
    assert_true(back.usable_travel.least == back.usable_travel.most);
    wb_json_destroy(document);
}

static void a_natural_bow_may_be_of_either_sign(void **state)
{
    (void)state;
    struct wb_test_piece piece, back;
    struct wb_json *const document = wb_json_create();
    assert_int_equal(wb_test_piece_parse("wire: w\nsample: 1\nouter_diameter_mm: 1\n"
                                         "natural_bow_mm: [-0.3, 0.1]\n",
                                         "s.yaml", WB_TEST_THREE_POINT, &piece, NULL),
                     WB_OK);
    wb_test_piece_set_json(&piece, document);
    assert_int_equal(wb_test_piece_get_json(&back, document, "d", NULL), WB_OK);
    assert_true(back.natural_bow.known);
    assert_close(back.natural_bow.least, -0.3e-3, 1e-15);
    assert_close(back.natural_bow.value, -0.1e-3, 1e-15);
    wb_json_destroy(document);
}

static void a_damaged_document_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"{\"length_mm\": -1}", "d: test_piece: length_mm"},
        {"{\"area_mm2\": 1}", "d: test_piece: constituent"},
        {"{\"usable_travel_mm\": [2, 1]}", "d: test_piece: usable_travel_mm"},
        {"{\"series\": 1}", "d: test_piece: series"},
    };
    struct wb_reason why = {{0}};
    struct wb_test_piece piece;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_json *document;
        assert_int_equal(wb_json_parse(&document, cases[i].text, "d"), WB_OK);
        assert_int_equal(wb_test_piece_get_json(&piece, document, "d", &why), WB_ERR_FORMAT);
        if (!strstr(why.text, cases[i].expected))
            fail_msg("'%s' does not say '%s'", why.text, cases[i].expected);
        wb_json_destroy(document);
    }
    assert_int_equal(wb_test_piece_get_json(&piece, NULL, "d", &why), WB_ERR_FORMAT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bent_wire_needs_no_wire_file),
        cmocka_unit_test(a_known_wire_gives_diameter_and_mass),
        cmocka_unit_test(areas_follow_from_what_is_given),
        cmocka_unit_test(bad_files_are_refused_with_the_reason),
        cmocka_unit_test(a_document_gives_the_same_piece_back),
        cmocka_unit_test(a_natural_bow_may_be_of_either_sign),
        cmocka_unit_test(a_damaged_document_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
