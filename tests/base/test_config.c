#include "tests/messages.h"
#include "tests/trials.h"

#include "base/config.h"
#include "base/units.h"

static int set_up(void **state)
{
    (void)state;
    keep_messages();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    release_messages();
    return 0;
}

struct sample {
    double length;
    int count;
    bool flag;
    char name[8];
    int colour;
    const struct wb_config_node *list;
};

static enum wb_status read_root(const struct wb_config_node *root, void *into)
{
    static const char *const colours[] = {"red", "blue", NULL};
    static const char *const old[] = {"size", "width", NULL};
    struct sample *const sample = into;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("length_mm", &sample->length, WB_MM, 1.0, 1000.0),
        WB_CONFIG_OPTIONAL_INTEGER("count", &sample->count, 0, 9),
        WB_CONFIG_OPTIONAL_BOOLEAN("flag", &sample->flag),
        WB_CONFIG_OPTIONAL_TEXT("name", sample->name),
        WB_CONFIG_OPTIONAL_CHOICE("colour", &sample->colour, colours),
        WB_CONFIG_OPTIONAL_NODE("list", &sample->list),
        WB_CONFIG_IGNORED("truth"),
        WB_CONFIG_IGNORED("width"),
    };
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    return wb_config_refuse_keys(root, old, "no longer used");
}

static enum wb_status read_sample(const char *text, struct sample *sample)
{
    *sample = (struct sample){.length = -1.0, .count = -1};
    return wb_config_load(text, "test.yaml", NULL, read_root, sample);
}

static void layouts_that_are_known_are_read(void **state)
{
    (void)state;
    struct sample sample;
    assert_int_equal(read_sample("schema: 1\nlength_mm: 85\n", &sample), WB_OK);
    assert_close(sample.length, 0.085, 1e-15);
    assert_int_equal(read_sample("length_mm: 85\nschema: 2\n", &sample), WB_ERR_FORMAT);
    assert_string_equal(kept.last, "test.yaml:2: schema: the file has layout 2, this program reads "
                                   "up to 1: use a newer wirebench");
    assert_int_equal(read_sample("length_mm: 85\nschema: one\n", &sample), WB_ERR_FORMAT);
    assert_int_equal(read_sample("length_mm: 85\nschema: 0\n", &sample), WB_ERR_FORMAT);
    /* Only at the top, and once. */
    assert_int_equal(read_sample("schema: 1\nlength_mm: 85\nschema: 1\n", &sample), WB_ERR_FORMAT);
    assert_non_null(strstr(kept.last, "given twice"));
}

static void a_layout_stands_at_the_top(void **state)
{
    (void)state;
    struct wb_config *config;
    double value;
    const struct wb_config_node *inner = NULL;
    const struct wb_config_key outer[] = {WB_CONFIG_NODE("inner", &inner)};
    const struct wb_config_key keys[] = {WB_CONFIG_NUMBER("x", &value, 1.0, 0.0, 9.0)};
    assert_int_equal(wb_config_parse(&config, "inner: {x: 1, schema: 1}\n", "t", NULL), WB_OK);
    assert_int_equal(wb_config_map(wb_config_root(config), outer, 1), WB_OK);
    assert_int_equal(wb_config_map(inner, keys, 1), WB_ERR_FORMAT);
    wb_config_destroy(config);
}

static void values_become_si(void **state)
{
    (void)state;
    struct sample sample;
    assert_int_equal(read_sample("length_mm: 85\ncount: 3\nflag: true\nname: abc\ncolour: blue\n"
                                 "truth: {a: [1, 2]}\n",
                                 &sample),
                     WB_OK);
    assert_close(sample.length, 0.085, 1e-15);
    assert_int_equal(sample.count, 3);
    assert_true(sample.flag);
    assert_string_equal(sample.name, "abc");
    assert_int_equal(sample.colour, 1);
    assert_null(sample.list);
    assert_int_equal(kept.n, 0);
}

static void absent_optional_keys_leave_their_target(void **state)
{
    (void)state;
    struct sample sample;
    assert_int_equal(read_sample("length_mm: 85", &sample), WB_OK);
    assert_int_equal(sample.count, -1);
}

static void errors_name_file_line_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *text, *place, *reason;
    } cases[] = {
        {"length_mm: 85 mm", "test.yaml:1: length_mm", "expected a plain number"},
        {"length_mm: nan", "test.yaml:1: length_mm", "expected a plain number"},
        {"\nlength_mm: 0x20", "test.yaml:2: length_mm", "expected a plain number"},
        {"length_mm: 0.5", "test.yaml:1: length_mm", "out of range, expected 1 to 1000"},
        {"length_mm: [1]", "test.yaml:1: length_mm", "expected a number"},
        {"count: 3", "test.yaml:1: length_mm", "this key is missing"},
        {"length_mm: 85\nlenght: 3", "test.yaml:2: lenght", "unknown key; known here: length_mm"},
        {"length_mm: 85\nlength_mm: 86", "test.yaml:2: length_mm", "given twice, first in line 1"},
        {"length_mm: 85\ncount: 1.5", "test.yaml:2: count", "expected a whole number"},
        {"length_mm: 85\ncount: 12", "test.yaml:2: count", "out of range"},
        {"length_mm: 85\nflag: yes", "test.yaml:2: flag", "true or false"},
        {"length_mm: 85\nname: abcdefgh", "test.yaml:2: name", "text too long"},
        {"length_mm: 85\ncolour: green", "test.yaml:2: colour", "one of red, blue, not green"},
        {"length_mm: 85\nwidth: 1", "test.yaml:2: width", "no longer used"},
        {"- 1\n- 2", "test.yaml:1: ", "expected keys with values"},
        {"a: b: c", "test.yaml:1: ", "mapping"},
        {"a: [1, 2", "test.yaml:", ""},
        {"", "test.yaml: ", "empty"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct sample sample;
        kept.n = 0;
        assert_int_equal(read_sample(cases[i].text, &sample), WB_ERR_FORMAT);
        assert_int_equal(kept.n, 1);
        assert_non_null(strstr(kept.last, cases[i].place));
        assert_non_null(strstr(kept.last, cases[i].reason));
    }
}

static void lists_of_numbers_are_checked(void **state)
{
    (void)state;
    struct wb_config *config;
    const struct wb_config_key key = {
        .name = "markers_mm", .factor = WB_MM, .minimum = 0.0, .maximum = 100.0};
    double values[4];
    int n = 0;
    assert_int_equal(wb_config_parse(&config, "[0, 14.2, 85]", "test.yaml", NULL), WB_OK);
    assert_int_equal(wb_config_numbers(wb_config_root(config), &key, 2, 4, values, &n), WB_OK);
    assert_int_equal(n, 3);
    assert_close(values[1], 0.0142, 1e-15);
    assert_int_equal(wb_config_numbers(wb_config_root(config), &key, 2, 2, values, &n),
                     WB_ERR_FORMAT);
    wb_config_destroy(config);
    assert_int_equal(wb_config_parse(&config, "[0, 200]", "test.yaml", NULL), WB_OK);
    assert_int_equal(wb_config_numbers(wb_config_root(config), &key, 1, 4, values, &n),
                     WB_ERR_FORMAT);
    wb_config_destroy(config);
}

static void checks_after_the_table_name_the_line_of_the_key(void **state)
{
    (void)state;
    struct wb_config *config;
    assert_int_equal(wb_config_parse(&config, "a: 1\nb:\n  c: 2\n  d: 3\n", "test.yaml", NULL),
                     WB_OK);
    const struct wb_config_node *const root = wb_config_root(config);
    const struct wb_config_node *const b = wb_config_find(root, "b");
    assert_non_null(b);
    assert_null(wb_config_find(root, "d"));
    assert_null(wb_config_find(wb_config_find(root, "a"), "a"));
    assert_string_equal(wb_config_scalar(wb_config_find(b, "d")), "3");
    assert_int_equal(wb_config_refuse(b, "d", "wrong"), WB_ERR_FORMAT);
    assert_string_equal(kept.last, "test.yaml:4: d: wrong");
    assert_int_equal(wb_config_refuse(b, "absent", "missing"), WB_ERR_FORMAT);
    assert_string_equal(kept.last, "test.yaml:3: absent: missing");
    wb_config_destroy(config);
}

static void common_slips_are_told_how_to_be_mended(void **state)
{
    (void)state;
    struct sample sample;
    assert_int_equal(read_sample("length_mm: 85,5\n", &sample), WB_ERR_FORMAT);
    assert_non_null(strstr(kept.last, "write 85.5"));
    assert_int_equal(read_sample("length_mm: 1,2,3\n", &sample), WB_ERR_FORMAT);
    assert_null(strstr(kept.last, "write"));
    assert_int_equal(read_sample("length_mm 85\ncount: 1\n", &sample), WB_ERR_FORMAT);
    assert_non_null(strstr(kept.last, "is a colon missing in the line before?"));
}

static void a_missing_file_is_named(void **state)
{
    (void)state;
    struct wb_config *config;
    assert_int_equal(wb_config_read(&config, "/no/such/file.yaml", NULL), WB_ERR_NOT_FOUND);
    assert_null(config);
    assert_non_null(strstr(kept.last, "/no/such/file.yaml"));
    assert_int_equal(kept.n, 1);
}

/* Not a proof, but it has found slips: mutations of a valid text never crash the reader. */
static void mangled_texts_never_crash(void **state)
{
    (void)state;
    static const char seed[] = "length_mm: 85\ncount: &a 3\nlist: [*a, {b: c}, 'd']\nname: \"x\"\n";
    uint32_t random = 12345;
    for (int i = 0; i < 20000; i++) {
        char text[sizeof seed];
        memcpy(text, seed, sizeof seed);
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            text[(random >> 8) % (sizeof seed - 1)] = (char)(random >> 24);
        }
        struct sample sample;
        const enum wb_status status = read_sample(text, &sample);
        assert_true(status == WB_OK || status == WB_ERR_FORMAT);
    }
    count_trials("Configuration texts with changed bytes", 20000, "texts: taken or refused");
}

static void a_reason_takes_what_would_be_logged(void **state)
{
    (void)state;
    struct wb_config *config;
    struct wb_reason why = {.text = ""};
    double length;
    const struct wb_config_key keys[] = {WB_CONFIG_NUMBER("length_mm", &length, WB_MM, 1.0, 9.0)};
    assert_int_equal(wb_config_read(&config, "/no/such/file.yaml", &why), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(why.text, "/no/such/file.yaml"));
    assert_int_equal(wb_config_parse(&config, "", "test.yaml", &why), WB_ERR_FORMAT);
    assert_string_equal(why.text, "test.yaml: the file is empty");
    assert_int_equal(wb_config_parse(&config, "length_mm: 10", "test.yaml", &why), WB_OK);
    assert_int_equal(wb_config_map(wb_config_root(config), keys, 1), WB_ERR_FORMAT);
    assert_non_null(strstr(why.text, "test.yaml:1: length_mm: 10 is out of range"));
    wb_config_destroy(config);
    assert_int_equal(kept.n, 0);
}

#define fact(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        fact(layouts_that_are_known_are_read),
        fact(a_layout_stands_at_the_top),
        fact(values_become_si),
        fact(absent_optional_keys_leave_their_target),
        fact(errors_name_file_line_and_key),
        fact(lists_of_numbers_are_checked),
        fact(checks_after_the_table_name_the_line_of_the_key),
        fact(common_slips_are_told_how_to_be_mended),
        fact(a_missing_file_is_named),
        fact(a_reason_takes_what_would_be_logged),
        fact(mangled_texts_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
