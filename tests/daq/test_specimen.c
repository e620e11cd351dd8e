#include "daq/protocol/specimen.h"

#include "tests/messages.h"

static const char good[] = "wire: type1\n"
                           "length_mm: 85\n"
                           "sample: 1\n"
                           "markers_mm: [0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]\n"
                           "marker_offset_mm: 1.0\n";

static void every_value_arrives_in_si(void **state)
{
    (void)state;
    struct wb_specimen specimen;
    assert_int_equal(wb_specimen_parse(good, "s.yaml", &specimen, NULL), WB_OK);
    assert_string_equal(specimen.wire, "type1");
    assert_close_relative(specimen.length, 0.085, 1e-15);
    assert_int_equal(specimen.sample, 1);
    assert_int_equal(specimen.n_markers, 7);
    assert_close_relative(specimen.markers[1], 0.0142, 1e-15);
    assert_close_relative(specimen.markers[6], 0.085, 1e-15);
    assert_close_relative(specimen.marker_offset, 1e-3, 1e-15);
    assert_close(specimen.marker_offset_uncertainty, 0.0, 0.0);
    assert_close(specimen.length_uncertainty, 0.0, 0.0);
    assert_int_equal(wb_specimen_parse("wire: type1\nlength_mm: 85\nu_length_mm: 0.25\nsample: 1\n"
                                       "markers_mm: [0, 85]\nmarker_offset_mm: 1\n",
                                       "s.yaml", &specimen, NULL),
                     WB_OK);
    assert_close_relative(specimen.length_uncertainty, 0.25e-3, 1e-15);
}

static void bad_files_are_rejected_with_the_reason(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *expected;
    } cases[] = {
        {"wire: type1\n", "", "wire: this key is missing"},
        {"wire: type1\n", "wire: ''\n", "s.yaml:1: wire: expected the name"},
        {"length_mm: 85\n", "length_mm: 85 mm\n", "s.yaml:2: length_mm: expected a plain number"},
        {"length_mm: 85\n", "length_m: 0.085\n", "s.yaml:2: length_m: unknown key"},
        {"sample: 1\n", "sample: 1\nu_length_mm: 0\n", "s.yaml:4: u_length_mm: 0 is out of range"},
        {"length_mm: 85\n", "length_mm: 86\n", "the last marker at the strand's knot"},
        {"sample: 1\n", "sample: 1.5\n", "sample: expected a whole number"},
        {"[0, 14.2", "[1, 14.2", "s.yaml:4: markers_mm: expected 0 first"},
        {"28.3, 42.5", "42.5, 28.3", "expected ascending arc lengths, but 28.3 follows 42.5"},
        {"28.3, 42.5", "28.3, 28.3", "expected ascending"},
        {"[0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]", "[0]", "1 numbers given, expected 2"},
        {"[0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]", "7", "expected a list of numbers"},
        {"56.7", "-56.7", "markers_mm: -56.7 is out of range"},
        {"marker_offset_mm: 1.0\n", "", "marker_offset_mm: this key is missing"},
    };
    keep_messages();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        struct wb_specimen specimen;
        const char *const at = strstr(good, cases[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, cases[i].to,
                 at + strlen(cases[i].from));
        assert_int_equal(wb_specimen_parse(text, "s.yaml", &specimen, NULL), WB_ERR_FORMAT);
        assert_message(cases[i].expected);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_value_arrives_in_si),
        cmocka_unit_test(bad_files_are_rejected_with_the_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
