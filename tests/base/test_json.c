#include "tests/check.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/json.h"
#include "base/memory.h"
#include "tests/messages.h"

static void a_document_reads_back(void **state)
{
    (void)state;
    struct wb_json *root = wb_json_create();
    wb_json_set_text(root, "wire", "type \"1\" \xc2\xb5");
    wb_json_set_number(root, "force_N", 0.1);
    wb_json_set_integer(root, "t_ns", INT64_MAX);
    wb_json_set_boolean(root, "virtual", true);
    struct wb_json *points = wb_json_set_array(root, "points");
    wb_json_append_number(points, 1.0 / 3.0);
    wb_json_set_number(wb_json_append_object(points), "x", -2.0);
    char *const text = wb_json_format(root);
    wb_json_destroy(root);

    struct wb_json *again;
    assert_int_equal(wb_json_parse(&again, text, "text"), WB_OK);
    free(text);
    const char *wire;
    double number;
    int64_t integer;
    bool flag;
    assert_true(wb_json_get_text(again, "wire", &wire));
    assert_string_equal(wire, "type \"1\" \xc2\xb5");
    assert_true(wb_json_get_number(again, "force_N", &number) && number == 0.1);
    assert_true(wb_json_get_integer(again, "t_ns", &integer) && integer == INT64_MAX);
    assert_true(wb_json_get_boolean(again, "virtual", &flag) && flag);
    const struct wb_json *const list = wb_json_get(again, "points");
    assert_int_equal(wb_json_length(list), 2);
    assert_true(wb_json_number(wb_json_item(list, 0), &number) && number == 1.0 / 3.0);
    assert_true(wb_json_get_number(wb_json_item(list, 1), "x", &number) && number == -2.0);
    assert_false(wb_json_get_number(again, "wire", &number));
    assert_false(wb_json_get_number(again, "absent", &number));
    wb_json_destroy(again);
}

static void unsupported_values_become_null_or_ascii(void **state)
{
    (void)state;
    struct wb_json *root = wb_json_create();
    wb_json_set_number(root, "a", (double)NAN);
    wb_json_set_text(root, "b", NULL);
    wb_json_set_text(root, "c", "\xff!");
    /* Half of a surrogate pair, an overlong form, beyond the last character; and valid
     * characters. */
    wb_json_set_text(root, "d", "\xed\xa0\x80 \xc0\xaf \xf4\x90\x80\x80");
    wb_json_set_text(root, "e", "\xc3\xa9 \xf0\x9f\x98\x80 \xef\xbf\xbe");
    char *const text = wb_json_format(root);
    assert_string_equal(text, "{\n  \"a\": null,\n  \"b\": null,\n  \"c\": \"?!\",\n  "
                              "\"d\": \"??? ?? ????\",\n  "
                              "\"e\": \"\xc3\xa9 \xf0\x9f\x98\x80 \xef\xbf\xbe\"\n}\n");
    free(text);
    wb_json_destroy(root);
}

static void numbers_are_as_short_as_they_can_be(void **state)
{
    (void)state;
    struct wb_json *root = wb_json_create();
    struct wb_json *list = wb_json_set_array(root, "a");
    wb_json_append_number(list, 0.1);
    wb_json_append_number(list, 85.0);
    wb_json_append_object(list);
    wb_json_set_array(root, "b");
    char *const text = wb_json_format(root);
    assert_string_equal(text, "{\n  \"a\": [\n    0.1,\n    85,\n    {}\n  ],\n  \"b\": []\n}\n");
    free(text);
    char *const line = wb_json_format_line(root);
    assert_string_equal(line, "{\"a\": [0.1, 85, {}], \"b\": []}\n");
    free(line);
    wb_json_destroy(root);
}

static enum wb_status set_member(void *value)
{
    wb_json_set_object(value, "a key");
    return WB_OK;
}

static enum wb_status append_item(void *value)
{
    wb_json_append_number(value, 1.0);
    return WB_OK;
}

static void a_value_of_the_wrong_kind_ends_the_call_with_its_message(void **state)
{
    (void)state;
    struct wb_json *const root = wb_json_create();
    struct wb_json *const list = wb_json_set_array(root, "list");
    keep_messages();
    assert_int_equal(wb_memory_try(set_member, list), WB_ERR_MEMORY);
    assert_message("'a key' is set in a value that is not an object");
    assert_int_equal(wb_memory_try(append_item, root), WB_ERR_MEMORY);
    assert_message("not an array");
    assert_int_equal(wb_memory_try(set_member, NULL), WB_ERR_MEMORY);
    assert_message("not an object");
    release_messages();
    char *const text = wb_json_format(root);
    assert_string_equal(text, "{\n  \"list\": []\n}\n");
    free(text);
    wb_json_destroy(root);
}

static void setting_again_replaces_and_keeps_the_order(void **state)
{
    (void)state;
    struct wb_json *const root = wb_json_create();
    struct wb_json *const copied = wb_json_set_object(root, "a");
    wb_json_append_text(wb_json_set_array(copied, "list"), "x");
    wb_json_set_integer(root, "b", 1);
    wb_json_set_copy(root, "b", copied);
    wb_json_set_copy(root, "b", wb_json_get(root, "b"));
    wb_json_set_text(root, "a", "y");
    char *const text = wb_json_format(root);
    assert_string_equal(text, "{\n  \"a\": \"y\",\n  \"b\": {\n    \"list\": [\n      \"x\"\n"
                              "    ]\n  }\n}\n");
    free(text);
    wb_json_destroy(root);
}

static void invalid_json_is_rejected(void **state)
{
    (void)state;
    wb_log_set_sink(discard_message, NULL);
    static const char *const cases[] = {"", "[1]", "{\"a\": 1, \"a\": 2}", "{\"a\": nan}", "{"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_json *root;
        assert_int_equal(wb_json_parse(&root, cases[i], "text"), WB_ERR_FORMAT);
        assert_null(root);
    }
    wb_log_set_sink(NULL, NULL);
}

/* Checks whether two documents differ by more than 1e-9, and where. */
static void assert_differs(const char *one, const char *other, const char *const *ignored,
                           const char *expected)
{
    struct wb_json *a, *b;
    struct wb_json_difference difference;
    assert_int_equal(wb_json_parse(&a, one, "a"), WB_OK);
    assert_int_equal(wb_json_parse(&b, other, "b"), WB_OK);
    const bool differs = wb_json_differs(a, b, 1e-9, ignored, &difference);
    assert_int_equal(differs, expected != NULL);
    if (expected)
        assert_string_equal(difference.first.place, expected);
    wb_json_destroy(a);
    wb_json_destroy(b);
}

static void documents_are_compared_number_by_number(void **state)
{
    (void)state;
    assert_differs("{\"a\": [1, {\"b\": 2.5}]}", "{\"a\": [1.0, {\"b\": 2.5}]}", NULL, NULL);
    assert_differs("{\"a\": {\"b\": 1}}", "{\"a\": {\"b\": 1.0000000005}}", NULL, NULL);
    assert_differs("{\"a\": {\"b\": 1}}", "{\"a\": {\"b\": 1.000000002}}", NULL, "a.b");
    assert_differs("{\"a\": {\"b\": 1e-20}}", "{\"a\": {\"b\": 2e-20}}", NULL, "a.b");
    /* Values negligible compared with the largest of their array may differ. */
    assert_differs("{\"a\": [5, 1e-20]}", "{\"a\": [5, 2e-20]}", NULL, NULL);
    assert_differs("{\"a\": [5, 1e-8]}", "{\"a\": [5, 2e-8]}", NULL, "a[1]");
    assert_differs("{\"a\": [5, {\"b\": [true]}]}", "{\"a\": [5, {\"b\": [false]}]}", NULL,
                   "a[1].b[0]");
}

static void values_other_than_numbers_must_be_equal(void **state)
{
    (void)state;
    assert_differs("{\"a\": \"x\", \"c\": \"x\"}", "{\"a\": \"x\", \"c\": \"y\"}", NULL, "c");
    assert_differs("{\"a\": \"1\"}", "{\"a\": 1}", NULL, "a");
    assert_differs("{\"a\": null}", "{\"a\": null}", NULL, NULL);
    assert_differs("{\"a\": null}", "{\"a\": 0}", NULL, "a");
    assert_differs("{\"a\": {\"b\": 1}}", "{\"a\": {\"c\": 1}}", NULL, "a.c");
    assert_differs("{\"a\": [1, 2]}", "{\"a\": [1]}", NULL, "a");
    /* Members can be ignored at the top level only. */
    static const char *const t_and_u[] = {"t", "u", NULL};
    assert_differs("{\"t\": 1, \"a\": 1}", "{\"t\": 2, \"a\": 1, \"u\": 3}", t_and_u, NULL);
    assert_differs("{\"u\": 1, \"v\": 1}", "{\"u\": 2, \"v\": 2}", t_and_u, "v");
    assert_differs("{\"a\": {\"t\": 1}}", "{\"a\": {\"t\": 2}}", t_and_u, "a.t");
}

static void the_first_difference_is_named_with_both_values(void **state)
{
    (void)state;
    static const struct {
        const char *a, *b, *place, *of_a, *of_b;
    } cases[] = {
        {"{\"a\": 1, \"b\": [1, 2]}", "{\"b\": [1.0, 2], \"a\": 1.0000000001}", NULL, "", ""},
        {"{\"a\": 1}", "{\"a\": 1.00001}", "a", "1", "1.00001"},
        {"{\"a\": \"x\"}", "{\"a\": \"y\"}", "a", "'x'", "'y'"},
        {"{\"a\": \"1\"}", "{\"a\": 1}", "a", "'1'", "1"},
        {"{\"a\": true}", "{\"a\": false}", "a", "true", "false"},
        {"{\"a\": null}", "{\"a\": null}", NULL, "", ""},
        {"{\"a\": null}", "{\"a\": 0}", "a", "nothing", "0"},
        {"{\"c\": {\"d\": [{\"e\": 1}, {\"e\": 2}]}}", "{\"c\": {\"d\": [{\"e\": 1}, {\"e\": 3}]}}",
         "c.d[1].e", "2", "3"},
        {"{\"a\": [1]}", "{\"a\": [1, 2]}", "a", "a list of 1", "a list of 2"},
        {"{\"a\": 1}", "{}", "a", "1", "nothing"},
        {"{}", "{\"a\": {}}", "a", "nothing", "an object"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_json *a, *b;
        struct wb_json_difference found;
        assert_int_equal(wb_json_parse(&a, cases[i].a, "a"), WB_OK);
        assert_int_equal(wb_json_parse(&b, cases[i].b, "b"), WB_OK);
        assert_int_equal(wb_json_differs(a, b, 1e-9, NULL, &found), cases[i].place != NULL);
        assert_string_equal(found.first.place, cases[i].place ? cases[i].place : "");
        assert_string_equal(found.first.a, cases[i].of_a);
        assert_string_equal(found.first.b, cases[i].of_b);
        wb_json_destroy(a);
        wb_json_destroy(b);
    }
}

static void differences_are_counted_and_the_largest_named(void **state)
{
    (void)state;
    struct wb_json *a, *b;
    struct wb_json_difference found;
    assert_int_equal(wb_json_parse(&a, "{\"a\": 1, \"b\": [4, 2], \"c\": 1}", "a"), WB_OK);
    assert_int_equal(wb_json_parse(&b, "{\"a\": 1.25, \"b\": [4, 1], \"c\": 2}", "b"), WB_OK);
    assert_true(wb_json_differs(a, b, 1e-9, NULL, &found));
    assert_int_equal(found.n, 3);
    assert_string_equal(found.first.place, "a");
    assert_string_equal(found.most.place, "c");
    assert_true(found.largest == 0.5);
    wb_json_set_text(b, "a", "1");
    assert_true(wb_json_differs(a, b, 1e-9, NULL, &found));
    assert_string_equal(found.most.place, "a");
    assert_true(isinf(found.largest));
    wb_json_destroy(a);
    wb_json_destroy(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_document_reads_back),
        cmocka_unit_test(unsupported_values_become_null_or_ascii),
        cmocka_unit_test(numbers_are_as_short_as_they_can_be),
        cmocka_unit_test(a_value_of_the_wrong_kind_ends_the_call_with_its_message),
        cmocka_unit_test(setting_again_replaces_and_keeps_the_order),
        cmocka_unit_test(invalid_json_is_rejected),
        cmocka_unit_test(documents_are_compared_number_by_number),
        cmocka_unit_test(values_other_than_numbers_must_be_equal),
        cmocka_unit_test(the_first_difference_is_named_with_both_values),
        cmocka_unit_test(differences_are_counted_and_the_largest_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
