/* Rows of settings: options, files, JSON, checks, identity and words. */
#include "base/setting_private.h"

#include <stdlib.h>

#include "tests/check.h"

struct pair {
    double first, second; /* m, s */
};

struct example {
    double length; /* m */
    int count;
    bool is_on, is_off;
    char name[8];
    const char *path;
    int colour;
    bool has_pair;
    struct pair pair;
};

static const char *const colours[] = {"red", "green", "blue", NULL};

static const struct wb_setting pair_rows[] = {
    {WB_ROW_QUANTITY(pair, first, "first_mm", "mm", 1e-3, 0.0, 10.0, 0.0), .required = true},
    {WB_ROW_QUANTITY(pair, second, "second_s", NULL, 1.0, 1.0, 2.0, 0.0), .required = true},
};
static const struct wb_setting_table pair_table = {WB_SETTING_ROWS(pair_rows)};

/* The second follows from the first, and must not be 1.5. */
static int complete_pair(void *members, int n, char *problem, size_t size)
{
    struct pair *const pair = members;
    if (n == 1)
        pair->second = 0.0;
    if (pair->second != 1.5)
        return -1;
    snprintf(problem, size, "%g is not liked", pair->second);
    return 1;
}

static const struct wb_setting rows[] = {
    {WB_ROW_QUANTITY(example, length, "length_mm", "mm", 1e-3, 0.1, 1e6, 85.0),
     WB_ROW_OPTION("length-mm", "L", "Free length"), .applies = 1},
    {WB_ROW_INTEGER(example, count, "count", 1, 9, 0), WB_ROW_OPTION("count", "N", "How many"),
     .otherwise = "one for each", .applies = 2},
    {WB_ROW_BOOLEAN(example, is_on, "is_on", true), WB_ROW_OPTION("off", NULL, "Turn it off")},
    {WB_ROW_BOOLEAN(example, is_off, "is_off", false), WB_ROW_OPTION("on", NULL, "Turn it on")},
    {WB_ROW_TEXT(example, name, "name")},
    {WB_ROW_TEXT(example, path, "path")},
    {WB_ROW_CHOICE(example, colour, "colour", colours, 1), .help = "Colour"},
    {WB_ROW_LIST(example, pair, "pair", pair_table, has_pair), .argument = "F[,S]",
     .complete = complete_pair},
};
static const struct wb_setting_table table = {WB_SETTING_ROWS(rows)};

/* The row of that name or option. */
static const struct wb_setting *find(const char *name)
{
    for (size_t i = 0; i < table.n; i++) {
        if (strcmp(rows[i].name, name) == 0 ||
            (rows[i].option && strcmp(rows[i].option, name) == 0))
            return &rows[i];
    }
    fail_msg("no row '%s'", name);
    return NULL;
}

static char problem[WB_SETTING_PROBLEM];

static bool parse(struct example *example, const char *name, const char *argument)
{
    const struct wb_setting *const row = find(name);
    problem[0] = '\0';
    return wb_setting_parse(row, argument, example, problem);
}

static void defaults_are_filled_in(void **unused)
{
    (void)unused;
    struct example e = {.name = "x", .path = "y", .is_off = true, .has_pair = true};
    wb_setting_fill(&table, &e);
    assert_close(e.length, 0.085, 0.0);
    assert_int_equal(e.count, 0);
    assert_true(e.is_on && !e.is_off);
    assert_string_equal(e.name, "");
    assert_null(e.path);
    assert_int_equal(e.colour, 1);
    assert_false(e.has_pair);
}

static void options_are_read(void **unused)
{
    (void)unused;
    struct example e = {0}; /* a default of a list is not filled in */
    wb_setting_fill(&table, &e);
    assert_true(parse(&e, "length-mm", "0.1"));
    assert_close(e.length, 1e-4, 0.0);
    assert_true(parse(&e, "count", "9") && e.count == 9);
    assert_true(parse(&e, "off", NULL) && !e.is_on);
    assert_true(parse(&e, "on", NULL) && e.is_off);
    assert_true(parse(&e, "name", "1234567"));
    assert_string_equal(e.name, "1234567");
    assert_true(parse(&e, "path", "a long name of a file"));
    assert_string_equal(e.path, "a long name of a file");
    assert_true(parse(&e, "colour", "blue") && e.colour == 2);
    assert_false(e.has_pair);
    assert_true(parse(&e, "pair", "3,1.25") && e.has_pair);
    assert_close(e.pair.first, 3e-3, 0.0);
    assert_close(e.pair.second, 1.25, 0.0);
    assert_true(parse(&e, "pair", "4"));
    assert_close(e.pair.second, 0.0, 0.0);
}

static void wrong_options_are_refused_and_change_nothing(void **unused)
{
    (void)unused;
    static const struct {
        const char *name, *argument, *expected;
    } cases[] = {
        {"length-mm", "0.09", "expected a number from 0.1 to 1e6 mm, not '0.09'"},
        {"length-mm", "1000001", "expected a number from 0.1 to 1e6 mm"},
        {"length-mm", "5 mm", "not '5 mm'"},
        {"length-mm", "nan", "not 'nan'"},
        {"count", "0", "expected a whole number from 1 to 9, not '0'"},
        {"count", "2.5", "not '2.5'"},
        {"name", "12345678", "expected at most 7 bytes, not '12345678'"},
        {"colour", "gray", "expected red, green or blue, not 'gray'"},
        {"pair", "1,1,1", "expected F or F,S, not '1,1,1'"},
        {"pair", "1,", "expected a number from 1 to 2"},
        {"pair", "1,1.5", "second_s: 1.5 is not liked"},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        struct example e, before;
        memset(&e, 0, sizeof e);
        wb_setting_fill(&table, &e);
        before = e;
        if (parse(&e, cases[i].name, cases[i].argument) || !strstr(problem, cases[i].expected))
            fail_msg("%s '%s': '%s'", cases[i].name, cases[i].argument, problem);
        e.pair = before.pair; /* no one's until has_pair is set */
        assert_memory_equal(&e, &before, sizeof e);
    }
}

/* "0.8@1.2", where the first alone is not enough. */
static void lists_may_have_another_separator_and_need_all_members(void **unused)
{
    (void)unused;
    const struct wb_setting row = {WB_ROW_LIST(example, pair, "pair", pair_table, has_pair),
                                   .separator = '@', .argument = "F@S"};
    struct example e = {0};
    char text[WB_SETTING_VALUE];
    assert_true(wb_setting_parse(&row, "0.8@1.2", &e, problem));
    assert_true(e.has_pair);
    assert_close(e.pair.first, 0.8e-3, 1e-18);
    assert_close(e.pair.second, 1.2, 0.0);
    wb_setting_format(&row, &e, text);
    assert_string_equal(text, "0.8@1.2");
    static const char *const wrong[] = {"0.8", "0.8,1.2", "0.8@1.2@1", "@1.2", "0.8@"};
    for (size_t i = 0; i < WB_COUNT(wrong); i++)
        if (wb_setting_parse(&row, wrong[i], &e, problem))
            fail_msg("'%s' was taken", wrong[i]);
    assert_false(wb_setting_parse(&row, "0.8", &e, problem));
    assert_string_equal(problem, "expected F@S, not '0.8'");
}

static void a_word_may_stand_for_0(void **unused)
{
    (void)unused;
    struct wb_setting row = rows[0];
    struct example e = {.length = 1.0};
    row.zero = "none";
    assert_true(wb_setting_parse(&row, "none", &e, problem));
    assert_close(e.length, 0.0, 0.0);
    assert_false(wb_setting_parse(&row, "0", &e, problem));
    assert_string_equal(problem, "expected a number from 0.1 to 1e6 mm or none, not '0'");
}

/* Blanks end a number: 200 of them, cut off, would hide what follows. */
static void long_lists_are_refused_and_not_cut(void **unused)
{
    (void)unused;
    struct example e = {.has_pair = false};
    char argument[240];
    snprintf(argument, sizeof argument, "1,2%*sx", 200, "");
    assert_false(parse(&e, "pair", argument));
    assert_non_null(strstr(problem, "expected F or F,S, not '1,2 "));
    assert_false(e.has_pair);
}

static void lists_of_too_many_members_are_refused(void **unused)
{
    (void)unused;
    struct wb_setting nine[9], list = *find("pair");
    const struct wb_setting_table members = {.rows = nine, .n = WB_COUNT(nine)};
    struct wb_config *config;
    struct example e;
    wb_setting_fill(&table, &e);
    for (size_t i = 0; i < WB_COUNT(nine); i++)
        nine[i] = pair_rows[0];
    list.members = &members;
    assert_int_equal(wb_config_parse(&config, "{}", "text", NULL), WB_OK);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_setting_read_list(&list, wb_config_root(config), &e), WB_ERR_FORMAT);
    wb_log_set_sink(NULL, NULL);
    assert_false(e.has_pair);
    wb_config_destroy(config);
}

static enum wb_status read_text(struct example *example, const char *text, unsigned place)
{
    struct wb_config_key keys[WB_COUNT(rows)];
    struct wb_config *config;
    size_t n = wb_setting_keys(&table, place, example, keys);
    for (size_t i = 0; i < n; i++) /* text without an array is of options only */
        if (strcmp(keys[i].name, "path") == 0)
            keys[i] = keys[--n];
    assert_int_equal(wb_config_parse(&config, text, "text", NULL), WB_OK);
    const enum wb_status status = wb_config_map(wb_config_root(config), keys, n);
    wb_config_destroy(config);
    return status;
}

static void files_are_read_by_place(void **unused)
{
    (void)unused;
    struct example e;
    wb_setting_fill(&table, &e);
    assert_int_equal(read_text(&e, "length_mm: 2\nis_on: false\nname: abc\ncolour: red\n", 1),
                     WB_OK);
    assert_close(e.length, 2e-3, 0.0);
    assert_false(e.is_on);
    assert_string_equal(e.name, "abc");
    assert_int_equal(e.colour, 0);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(read_text(&e, "length_mm: 0.09\n", 1), WB_ERR_FORMAT);
    assert_int_equal(read_text(&e, "length_mm: 2\n", 2), WB_ERR_FORMAT);
    assert_int_equal(read_text(&e, "count: 10\n", 2), WB_ERR_FORMAT);
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(read_text(&e, "count: 9\n", 2), WB_OK);
    assert_int_equal(e.count, 9);
}

static enum wb_status read_pair(struct example *example, const char *text)
{
    struct wb_config *config;
    assert_int_equal(wb_config_parse(&config, text, "text", NULL), WB_OK);
    const enum wb_status status =
        wb_setting_read_list(find("pair"), wb_config_find(wb_config_root(config), "pair"), example);
    wb_config_destroy(config);
    return status;
}

static void lists_are_a_value_or_a_map(void **unused)
{
    (void)unused;
    struct example e;
    wb_setting_fill(&table, &e);
    e.has_pair = false;
    assert_int_equal(read_pair(&e, "pair: 7\n"), WB_OK);
    assert_true(e.has_pair);
    assert_close(e.pair.first, 7e-3, 0.0);
    assert_int_equal(read_pair(&e, "pair: {first_mm: 1, second_s: 2}\n"), WB_OK);
    assert_close(e.pair.second, 2.0, 0.0);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(read_pair(&e, "pair: 11\n"), WB_ERR_FORMAT);
    assert_int_equal(read_pair(&e, "pair: {first_mm: 1}\n"), WB_ERR_FORMAT);
    assert_int_equal(read_pair(&e, "pair: {first_mm: 1, second_s: 1.5}\n"), WB_ERR_FORMAT);
    wb_log_set_sink(NULL, NULL);
}

static void filled_structs_are_checked(void **unused)
{
    (void)unused;
    struct example e;
    wb_setting_fill(&table, &e);
    e.pair.second = 1.0;
    /* The count's default, 0, is out of its range. */
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_OK);
    e.length = 1e6 * 1e-3;
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_OK);
    wb_log_set_sink(discard_message, NULL);
    e.length = nextafter(e.length, 1e9);
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_ERR_ARGUMENT);
    e.length = (double)NAN;
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_ERR_ARGUMENT);
    e.length = 1.0;
    e.count = 10;
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_ERR_ARGUMENT);
    e.count = 1;
    e.pair.second = 3.0;
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

static void what_files_must_have_is_checked_at_zero_too(void **unused)
{
    (void)unused;
    struct pair pair = {0.0, 0.0};
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_setting_check(&pair_table, &pair, NULL), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    pair.second = 1.0;
    assert_int_equal(wb_setting_check(&pair_table, &pair, NULL), WB_OK);
    /* Of a list the second member may be left out. */
    struct example e;
    wb_setting_fill(&table, &e);
    assert_true(parse(&e, "pair", "4"));
    assert_int_equal(wb_setting_check(&table, &e, NULL), WB_OK);
}

static void a_text_that_there_is_not_is_empty(void **unused)
{
    (void)unused;
    const struct example none = {.path = NULL}, some = {.path = "a"};
    struct wb_json *const object = wb_json_create();
    char text[WB_SETTING_VALUE] = "of before";
    wb_setting_format(find("path"), &none, text);
    assert_string_equal(text, "");
    wb_setting_set_json(find("path"), &none, object);
    const char *stored;
    assert_non_null(wb_json_get(object, "path"));
    assert_false(wb_json_get_text(object, "path", &stored)); /* null */
    wb_setting_set_json(find("path"), &some, object);
    assert_true(wb_json_get_text(object, "path", &stored));
    assert_string_equal(stored, "a");
    wb_json_destroy(object);
}

static void only_what_is_not_zero_is_given(void **unused)
{
    (void)unused;
    const struct example zero = {0};
    const struct example full = {.length = 1.0,
                                 .count = 1,
                                 .is_on = true,
                                 .is_off = true,
                                 .name = "a",
                                 .path = "b",
                                 .colour = 1,
                                 .has_pair = true};
    for (size_t i = 0; i < table.n; i++) {
        assert_false(wb_setting_is_given(&rows[i], &zero));
        assert_true(wb_setting_is_given(&rows[i], &full));
    }
}

static void only_what_is_not_the_default_differs(void **unused)
{
    (void)unused;
    struct example e = {0};
    wb_setting_fill(&table, &e);
    for (size_t i = 0; i < table.n; i++)
        assert_false(wb_setting_differs(&rows[i], &e));
    const struct example other = {
        .length = 0.086, .count = 1, .is_off = true, .name = "a", .path = "b", .has_pair = true};
    for (size_t i = 0; i < table.n; i++)
        assert_true(wb_setting_differs(&rows[i], &other));
}

static void json_holds_values_in_the_rows_units(void **unused)
{
    (void)unused;
    struct example e = {.count = 3, .name = "ab", .path = "cd", .is_on = true};
    struct wb_json *const object = wb_json_create();
    char *text;
    e.length = 0.5;
    e.pair = (struct pair){2e-3, 1.0};
    for (size_t i = 0; i < table.n; i++)
        wb_setting_set_json(&rows[i], &e, object);
    text = wb_json_format(object);
    assert_non_null(strstr(text, "\"length_mm\": 500"));
    assert_non_null(strstr(text, "\"colour\": \"red\""));
    assert_non_null(strstr(text, "\"first_mm\": 2"));
    free(text);
    wb_json_destroy(object);
}

static void values_are_written_as_options_take_them(void **unused)
{
    (void)unused;
    struct example e = {.length = 0.0123, .name = "ab", .pair = {1e-3, 1.25}};
    char text[WB_SETTING_VALUE];
    wb_setting_format(&rows[0], &e, text);
    assert_string_equal(text, "12.3");
    wb_setting_format(find("name"), &e, text);
    assert_string_equal(text, "ab");
    wb_setting_format(find("pair"), &e, text);
    assert_string_equal(text, "1,1.25");
    e.pair.second = 0.0;
    wb_setting_format(find("pair"), &e, text);
    assert_string_equal(text, "1");
}

static void help_has_range_and_default(void **unused)
{
    (void)unused;
    static const struct {
        const char *name, *otherwise, *expected;
    } cases[] = {
        {"length_mm", NULL, "Free length: 0.1 to 1e6 mm (85)"},
        {"length_mm", "the file's", "Free length: 0.1 to 1e6 mm (the file's)"},
        {"count", NULL, "How many: 1 to 9 (one for each)"},
        {"is_on", NULL, "Turn it off"},
        {"colour", NULL, "Colour: red, green or blue (green)"},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        struct wb_text text = {0};
        wb_setting_describe(find(cases[i].name), cases[i].otherwise, &text);
        assert_string_equal(wb_text_string(&text), cases[i].expected);
        wb_text_release(&text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_filled_in),
        cmocka_unit_test(options_are_read),
        cmocka_unit_test(wrong_options_are_refused_and_change_nothing),
        cmocka_unit_test(lists_may_have_another_separator_and_need_all_members),
        cmocka_unit_test(a_word_may_stand_for_0),
        cmocka_unit_test(long_lists_are_refused_and_not_cut),
        cmocka_unit_test(lists_of_too_many_members_are_refused),
        cmocka_unit_test(files_are_read_by_place),
        cmocka_unit_test(lists_are_a_value_or_a_map),
        cmocka_unit_test(filled_structs_are_checked),
        cmocka_unit_test(what_files_must_have_is_checked_at_zero_too),
        cmocka_unit_test(a_text_that_there_is_not_is_empty),
        cmocka_unit_test(only_what_is_not_zero_is_given),
        cmocka_unit_test(only_what_is_not_the_default_differs),
        cmocka_unit_test(json_holds_values_in_the_rows_units),
        cmocka_unit_test(values_are_written_as_options_take_them),
        cmocka_unit_test(help_has_range_and_default),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
