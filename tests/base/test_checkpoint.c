/* Checkpoints: saved values are restored, and other files are rejected. */
#include "tests/own_folder.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/checkpoint.h"
#include "base/file.h"

static char path[64];

static int set_up(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    snprintf(path, sizeof path, "%s/state", folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder);
}

struct numbers {
    double x[1000];
    int n;
    char text[9];
};

static void visit(struct wb_checkpoint *c, struct numbers *numbers)
{
    wb_checkpoint_visit(c, "x", numbers->x, sizeof numbers->x);
    wb_checkpoint_visit_member(c, numbers, n);
    wb_checkpoint_visit_member(c, numbers, text);
}

static void write_numbers(struct numbers *numbers)
{
    struct wb_checkpoint c;
    for (int i = 0; i < 1000; i++)
        numbers->x[i] = 1.0 / (i + 1);
    numbers->n = -7;
    memcpy(numbers->text, "\n\0end\n\0", 8);
    wb_checkpoint_init(&c);
    visit(&c, numbers);
    assert_int_equal(wb_checkpoint_finish(&c), WB_OK);
    assert_int_equal(wb_checkpoint_write(&c, path, "seven wires"), WB_OK);
    wb_checkpoint_release(&c);
}

static void saved_values_are_restored(void **unused)
{
    (void)unused;
    struct numbers out = {.n = 0}, in = {.n = 0};
    struct wb_checkpoint c;
    write_numbers(&out);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_OK);
    visit(&c, &in);
    assert_int_equal(wb_checkpoint_finish(&c), WB_OK);
    assert_memory_equal(in.x, out.x, sizeof in.x);
    assert_int_equal(in.n, -7);
    assert_memory_equal(in.text, out.text, sizeof in.text);
    wb_checkpoint_rewind(&c);
    wb_checkpoint_visit(&c, "x", in.x, sizeof in.x);
    wb_checkpoint_release(&c);
}

static void discard(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)level, (void)domain;
    snprintf(context, 256, "%s", message);
}

static void missing_and_surplus_fields_are_detected(void **unused)
{
    (void)unused;
    struct numbers out = {.n = 0}, in = {.n = 0};
    struct wb_checkpoint c;
    char message[256] = "";
    wb_log_set_sink(discard, message);
    write_numbers(&out);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_OK);
    wb_checkpoint_visit(&c, "x", in.x, sizeof in.x);
    assert_int_equal(wb_checkpoint_finish(&c), WB_ERR_DATA);
    assert_non_null(strstr(message, "unexpected field 'n'"));
    wb_checkpoint_release(&c);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_OK);
    visit(&c, &in);
    visit(&c, &in);
    assert_int_equal(wb_checkpoint_finish(&c), WB_ERR_DATA);
    assert_non_null(strstr(message, "field 'x' is missing"));
    wb_checkpoint_release(&c);
    wb_log_set_sink(NULL, NULL);
}

/* Leaves the values unchanged. */
static void wrong_field_name_or_size_is_reported(void **unused)
{
    (void)unused;
    struct numbers out = {.n = 0}, in = {.n = 1};
    struct wb_checkpoint c;
    char message[256] = "";
    wb_log_set_sink(discard, message);
    write_numbers(&out);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_OK);
    wb_checkpoint_visit_member(&c, &in, n);
    assert_int_equal(wb_checkpoint_finish(&c), WB_ERR_DATA);
    assert_int_equal(in.n, 1);
    assert_non_null(strstr(message, "expected field 'n', found 'x'"));
    wb_checkpoint_release(&c);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_OK);
    wb_checkpoint_visit(&c, "x", in.x, sizeof in.x - 8);
    assert_int_equal(wb_checkpoint_finish(&c), WB_ERR_DATA);
    assert_true(in.x[0] == 0.0);
    assert_non_null(strstr(message, "'x' has 8000 bytes: expected 7992"));
    wb_checkpoint_release(&c);
    wb_log_set_sink(NULL, NULL);
}

/* The states of three parts are saved separately and combined. */
static void groups_name_their_fields_and_can_be_skipped(void **unused)
{
    (void)unused;
    struct wb_checkpoint all;
    char message[256] = "";
    int value = 0;

    wb_checkpoint_init(&all);
    for (int part = 1; part <= 3; part++) {
        struct wb_checkpoint own;
        wb_checkpoint_init(&own);
        wb_checkpoint_enter(&own, "part %d", part);
        wb_checkpoint_enter(&own, "wire");
        value = 10 * part;
        wb_checkpoint_visit(&own, "a", &value, sizeof value);
        wb_checkpoint_leave(&own);
        wb_checkpoint_visit(&own, "b", &value, sizeof value);
        wb_checkpoint_leave(&own);
        assert_string_equal(own.group, "");
        wb_checkpoint_append(&all, own.bytes, own.size);
        wb_checkpoint_release(&own);
    }
    wb_checkpoint_rewind(&all);
    for (int part = 1; part <= 3; part++) {
        wb_checkpoint_enter(&all, "part %d", part);
        if (part == 2) {
            wb_checkpoint_enter(&all, "wire");
            wb_checkpoint_visit(&all, "a", &value, sizeof value);
            wb_checkpoint_leave(&all);
            assert_int_equal(value, 20);
        }
        wb_checkpoint_skip(&all);
        wb_checkpoint_leave(&all);
    }
    assert_int_equal(wb_checkpoint_finish(&all), WB_OK);

    wb_log_set_sink(discard, message);
    wb_checkpoint_rewind(&all);
    wb_checkpoint_enter(&all, "part 1");
    wb_checkpoint_visit(&all, "a", &value, sizeof value);
    assert_int_equal(wb_checkpoint_finish(&all), WB_ERR_DATA);
    assert_non_null(strstr(message, "expected field 'part 1/a', found 'part 1/wire/a'"));
    wb_log_set_sink(NULL, NULL);
    wb_checkpoint_release(&all);
}

static void too_deep_groups_are_rejected(void **unused)
{
    (void)unused;
    struct wb_checkpoint c;
    char message[256] = "";

    wb_checkpoint_init(&c);
    wb_log_set_sink(discard, message);
    for (int i = 0; i < 100; i++)
        wb_checkpoint_enter(&c, "group");
    assert_int_equal(wb_checkpoint_finish(&c), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    wb_checkpoint_release(&c);
}

/* Changes the byte there, or truncates the file. */
static void damage(long at, bool cut)
{
    char *bytes;
    size_t size;
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    if (!cut)
        bytes[at >= 0 ? at : (long)size + at] ^= 1;
    assert_int_equal(wb_file_write(path, bytes, cut ? size - 1 : size), WB_OK);
    free(bytes);
}

static void other_and_damaged_files_are_rejected(void **unused)
{
    (void)unused;
    struct numbers out = {.n = 0};
    struct wb_checkpoint c;
    char message[256] = "";
    wb_log_set_sink(discard, message);
    write_numbers(&out);
    assert_int_equal(wb_checkpoint_read(&c, path, "twelve wires"), WB_ERR_DATA);
    assert_non_null(strstr(message, "another run"));
    assert_non_null(strstr(message, "seven wires"));
    damage(-1, false);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_ERR_FORMAT);
    assert_non_null(strstr(message, "damaged"));
    write_numbers(&out);
    damage(0, true);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_ERR_FORMAT);
    write_numbers(&out);
    damage(0, false);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_ERR_FORMAT);
    assert_non_null(strstr(message, "not a checkpoint"));
    const char old[] = "wirebench checkpoint 1\nseven wires\n0\n0\nend\n";
    assert_int_equal(wb_file_write(path, old, strlen(old)), WB_OK);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_ERR_FORMAT);
    assert_non_null(strstr(message, "a checkpoint of version 1"));
    assert_int_equal(wb_file_write(path, "", 0), WB_OK);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_ERR_FORMAT);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(wb_checkpoint_read(&c, path, "seven wires"), WB_ERR_NOT_FOUND);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(saved_values_are_restored),
        cmocka_unit_test(missing_and_surplus_fields_are_detected),
        cmocka_unit_test(wrong_field_name_or_size_is_reported),
        cmocka_unit_test(groups_name_their_fields_and_can_be_skipped),
        cmocka_unit_test(too_deep_groups_are_rejected),
        cmocka_unit_test(other_and_damaged_files_are_rejected),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
