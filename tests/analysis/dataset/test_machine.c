#include "analysis/dataset/machine_private.h"

#include <stdlib.h>

#include "tests/messages.h"

static const char rollers[] = "name: rollers\n"
                              "kind: three-point\n"
                              "span_mm: 12.8\n"
                              "roller_radius_mm: 2\n"
                              "nose_radius_mm: [4, 5]\n"
                              "friction: 0.3\n"
                              "compliance_mm_N: 0.002\n";

static void every_value_arrives_in_si(void **state)
{
    (void)state;
    struct wb_machine machine;
    assert_int_equal(wb_machine_parse(rollers, "m.yaml", &machine, NULL), WB_OK);
    assert_string_equal(machine.name, "rollers");
    assert_int_equal(machine.kind, WB_TEST_THREE_POINT);
    assert_close_relative(machine.span, 12.8e-3, 1e-15);
    assert_close_relative(machine.roller_radius, 2e-3, 1e-15);
    assert_true(machine.nose_radius.known);
    assert_close_relative(machine.nose_radius.least, 4e-3, 1e-15);
    assert_close_relative(machine.nose_radius.value, 4.5e-3, 1e-15);
    assert_close_relative(machine.nose_radius.most, 5e-3, 1e-15);
    assert_close_relative(machine.friction.least, 0.3, 1e-15);
    assert_close_relative(machine.friction.most, 0.3, 1e-15);
    assert_close_relative(machine.compliance.value, 2e-6, 1e-15);
    assert_false(machine.speed.known);
    assert_true(isnan(machine.gauge_length) && isnan(machine.speed.value));
}

static void a_tensile_machine_says_whose_elongation_it_is(void **state)
{
    (void)state;
    struct wb_machine machine;
    const char *const text = "name: t\nkind: tensile\ngauge_length_mm: 50\nelongation: %s\n";
    char filled[256];
    for (int own = 0; own < 2; own++) {
        snprintf(filled, sizeof filled, text, own ? "extensometer" : "crosshead");
        assert_int_equal(wb_machine_parse(filled, "m.yaml", &machine, NULL), WB_OK);
        assert_int_equal(machine.own_elongation, own);
        assert_close_relative(machine.gauge_length, 0.05, 1e-15);
    }
}

static void bad_files_are_refused_with_the_reason(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *expected;
    } cases[] = {
        {"kind: three-point\n", "", "kind: this key is missing"},
        {"kind: three-point\n", "kind: bending\n",
         "m.yaml:2: kind: expected one of cantilever, three-point, tensile"},
        {"span_mm: 12.8\n", "", "span_mm: this key is missing for a three-point test"},
        {"span_mm: 12.8\n", "span_mm: 0\n", "m.yaml:3: span_mm: 0 is out of range"},
        {"span_mm: 12.8\n", "span_mm: [12, 13]\n", "m.yaml:3: span_mm: expected a number"},
        {"span_mm: 12.8\n", "span: 12.8\n", "m.yaml:3: span: unknown key"},
        {"friction: 0.3\n", "friction: [0.6, 0]\n",
         "m.yaml:6: friction: expected the least first: [0, 0.6]"},
        {"friction: 0.3\n", "friction: [0.6]\n", "friction: 1 numbers given"},
        {"friction: 0.3\n", "gauge_length_mm: 50\n",
         "m.yaml:6: gauge_length_mm: a three-point test has none"},
        {"kind: three-point\n", "kind: tensile\n", "span_mm: a tensile test has none"},
    };
    keep_messages();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        struct wb_machine machine;
        const char *const at = strstr(rollers, cases[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - rollers), rollers, cases[i].to,
                 at + strlen(cases[i].from));
        assert_int_equal(wb_machine_parse(text, "m.yaml", &machine, NULL), WB_ERR_FORMAT);
        assert_message(cases[i].expected);
    }
    release_messages();
}

static void a_document_gives_the_same_machine_back(void **state)
{
    (void)state;
    static const char *const texts[] = {
        rollers,
        "name: t\nkind: tensile\ngauge_length_mm: 50\nelongation: extensometer\n",
        "name: c\nkind: cantilever\nbends: sideways\nspeed_mm_s: 1\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct wb_machine machine, back;
        char *first, *second;
        struct wb_json *const document = wb_json_create();
        struct wb_json *const again = wb_json_create();
        assert_int_equal(wb_machine_parse(texts[i], "m.yaml", &machine, NULL), WB_OK);
        wb_machine_set_json(&machine, document);
        assert_int_equal(wb_machine_get_json(&back, document, "d", NULL), WB_OK);
        assert_int_equal(back.kind, machine.kind);
        assert_int_equal(back.own_elongation, machine.own_elongation);
        assert_int_equal(back.bends, machine.bends);
        wb_machine_set_json(&back, again);
        first = wb_json_format(document);
        second = wb_json_format(again);
        assert_string_equal(first, second);
        free(first);
        free(second);
        wb_json_destroy(document);
        wb_json_destroy(again);
    }
}

static void a_damaged_document_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"{\"name\": \"t\", \"kind\": \"tensile\", \"gauge_length_mm\": 50}",
         "d: machine.elongation: expected crosshead or extensometer"},
        {"{\"name\": \"t\", \"kind\": \"tensile\", \"elongation\": \"crosshead\"}",
         "d: machine.gauge_length_mm: expected a number"},
        {"{\"name\": \"t\", \"kind\": \"other\"}", "d: machine.kind: expected cantilever"},
        {"{\"kind\": \"tensile\"}", "d: machine.name"},
        {"{\"name\": \"t\", \"kind\": \"three-point\", \"span_mm\": 10, \"roller_radius_mm\": 1, "
         "\"friction\": [0.6, 0]}",
         "d: machine.friction: expected a number from 0 to 10, or a list of two"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_json *document;
        struct wb_machine machine;
        struct wb_reason why = {{0}};
        assert_int_equal(wb_json_parse(&document, cases[i].text, "d"), WB_OK);
        assert_int_equal(wb_machine_get_json(&machine, document, "d", &why), WB_ERR_FORMAT);
        if (!strstr(why.text, cases[i].expected))
            fail_msg("'%s' does not say '%s'", why.text, cases[i].expected);
        wb_json_destroy(document);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_value_arrives_in_si),
        cmocka_unit_test(a_tensile_machine_says_whose_elongation_it_is),
        cmocka_unit_test(bad_files_are_refused_with_the_reason),
        cmocka_unit_test(a_document_gives_the_same_machine_back),
        cmocka_unit_test(a_damaged_document_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
