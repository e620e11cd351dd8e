/* Strict tables: analysis/csv_table.h. Files are in test_fields.c and test_surface.c. */
#include "analysis/dataset/csv_table_private.h"
#include "base/config.h"
#include "tests/messages.h"

enum {
    COLUMNS = 2
};

static int sum, taken;

static int listen(void **state)
{
    (void)state;
    keep_messages();
    return 0;
}

static enum wb_status take(void *context, const struct wb_csv_table *table, char *const *fields)
{
    int value;
    assert_ptr_equal(context, &sum);
    WB_TRY(wb_csv_table_integer(table, 1, fields, 9, &value));
    if (strcmp(fields[0], "no") == 0)
        return wb_csv_table_refuse(table, 0, "anything else", fields[0]);
    sum += value;
    taken++;
    return WB_OK;
}

static enum wb_status parse(const char *source, size_t size)
{
    static const char *const columns[COLUMNS] = {"name", "number"};
    char text[200];
    struct wb_csv_table table = {
        .path = "t.csv", .n_columns = COLUMNS, .columns = columns, .take = take, .context = &sum};
    sum = taken = 0;
    memcpy(text, source, size + 1);
    return wb_csv_table_parse(&table, text, size);
}

static void rows_are_taken_in_turn(void **state)
{
    (void)state;
    static const char *const same[] = {"name,number\na,3\nb,9\n", "name,number\r\na,3\r\nb,9\r\n",
                                       "name,number\na,3\nb,9"};
    for (size_t i = 0; i < WB_COUNT(same); i++) {
        assert_int_equal(parse(same[i], strlen(same[i])), WB_OK);
        assert_int_equal(sum, 12);
        assert_int_equal(taken, 2);
    }
    assert_int_equal(parse("name,number\n", 12), WB_OK);
    assert_int_equal(taken, 0);
}

static void what_is_wrong_is_told_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } wrong[] = {
        {"", "t.csv:1: empty file, expected a line of column names"},
        {"name\n", "t.csv:1: 1 fields, expected 2"},
        {"name,size\n", "t.csv:1: expected column 'number', not 'size'"},
        {"name,number\na,3\nb\n", "t.csv:3: 1 fields, expected 2"},
        {"name,number\na,3,4\n", "t.csv:2: 3 fields, expected 2"},
        {"name,number\na,10\n", "t.csv:2: number: expected a whole number from 0 to 9, not '10'"},
        {"name,number\na,-1\n", "t.csv:2: number: expected a whole number from 0 to 9, not '-1'"},
        {"name,number\nno,1\n", "t.csv:2: name: expected anything else, not 'no'"},
    };
    for (size_t i = 0; i < WB_COUNT(wrong); i++) {
        assert_int_equal(parse(wrong[i].text, strlen(wrong[i].text)), WB_ERR_FORMAT);
        assert_string_equal(kept.last, wrong[i].message);
    }
    assert_int_equal(parse("name,number\na,\0003\n", 17), WB_ERR_FORMAT);
    assert_string_equal(kept.last, "t.csv: a byte 0: not a text file");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_taken_in_turn),
        cmocka_unit_test(what_is_wrong_is_told_with_its_line),
    };
    return cmocka_run_group_tests(tests, listen, NULL);
}
