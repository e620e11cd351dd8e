#include "base/reads.h"

#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "tests/own_folder.h"

static const char *in_folder(const char *name)
{
    static char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    return path;
}

static void write_and_read(const char *name, const char *text)
{
    char *bytes;
    assert_int_equal(wb_file_write(in_folder(name), text, strlen(text)), WB_OK);
    assert_int_equal(wb_file_read(in_folder(name), &bytes, NULL), WB_OK);
    free(bytes);
}

static void files_are_noted_once_with_their_contents(void **state)
{
    (void)state;
    struct wb_read read;
    char sha256[WB_SHA256_TEXT];
    write_and_read("before", "x");
    wb_reads_start();
    write_and_read("a", "one");
    write_and_read("b", "two");
    write_and_read("a", "one");
    assert_int_equal(wb_reads_count(), 2);
    assert_true(wb_reads_at(0, &read));
    wb_hash_bytes("one", 3, sha256);
    assert_string_equal(read.path, in_folder("a"));
    assert_string_equal(read.sha256, sha256);

    write_and_read("a", "changed");
    assert_int_equal(wb_reads_count(), 3);
    assert_false(wb_reads_at(3, &read));
    wb_reads_stop();
    assert_int_equal(wb_reads_count(), 0);
    write_and_read("a", "one");
    assert_int_equal(wb_reads_count(), 0);
}

static void a_file_is_the_same_by_a_link(void **state)
{
    (void)state;
    char target[WB_PATH], *bytes;
    snprintf(target, sizeof target, "%s", in_folder("target"));
    wb_reads_start();
    write_and_read("target", "text");
    assert_int_equal(symlink(target, in_folder("link")), 0);
    assert_int_equal(wb_file_read(in_folder("link"), &bytes, NULL), WB_OK);
    free(bytes);
    assert_int_equal(wb_reads_count(), 1);
    wb_reads_stop();
}

static void a_file_is_removed_and_later_ones_are_dropped(void **state)
{
    (void)state;
    struct wb_read read;
    wb_reads_start();
    write_and_read("a", "one");
    write_and_read("b", "two");
    write_and_read("a", "changed");
    write_and_read("c", "three");
    wb_reads_leave_out(in_folder("a"));
    assert_int_equal(wb_reads_count(), 2);
    wb_reads_forget(1);
    assert_int_equal(wb_reads_count(), 1);
    assert_true(wb_reads_at(0, &read));
    assert_string_equal(read.path, in_folder("b"));
    wb_reads_stop();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_noted_once_with_their_contents),
        cmocka_unit_test(a_file_is_the_same_by_a_link),
        cmocka_unit_test(a_file_is_removed_and_later_ones_are_dropped),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
