/* The index of recordings: reading and appending. (tests/analysis/report/bench tests its use by
 * campaigns.) */
#include "daq/recording/index.h"

#include <stdlib.h>

#include "base/units.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

#define SHA_A "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
#define SHA_B "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb"
#define HEAD "- file: a.wbr\n  wire: type1\n  length_mm: 85\n  sample: 1\n  sha256: " SHA_A "\n"

static const char *write_index(const char *text)
{
    static char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, WB_INDEX_FILE), WB_OK);
    assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
    return path;
}

static struct wb_index_entry example(const char *file)
{
    struct wb_index_entry entry = {.wire = "type1",
                                   .length = 85.0 * WB_MM,
                                   .sample = 7,
                                   .sha256 = SHA_B,
                                   .cycles = 2,
                                   .seed = -1,
                                   .date_utc = "2026-11-23T20:12:00Z",
                                   .is_virtual = true,
                                   .series = "it's a series",
                                   .number = 12};
    snprintf(entry.file, sizeof entry.file, "%s", file);
    return entry;
}

static void exclusion_needs_a_person_and_a_reason(void **state)
{
    (void)state;
    struct wb_index index;
    char text[WB_INDEX_EXCLUSION_TEXT];
    const char *path = write_index(HEAD "  excluded: {by: A. Tester, reason: it slipped, date_utc: "
                                        "'2026-11-23T20:12:00Z'}\n");
    assert_int_equal(wb_index_read(&index, path, NULL), WB_OK);
    assert_true(index.entries[0].excluded.is_excluded);
    assert_false(index.entries[0].excluded.is_repeated);
    wb_index_exclusion_describe(&index.entries[0].excluded, text);
    assert_string_equal(text, "by A. Tester on 2026-11-23: it slipped");
    wb_index_release(&index);
    static const char *const bad[][2] = {
        {HEAD "  excluded: {by: A. Tester}\n", "reason"},
        {HEAD "  excluded: {reason: it slipped}\n", "by"},
        {HEAD "  excluded:\n    by: A. Tester\n    reason: ''\n", "index.yaml:8: reason: expected"},
        {HEAD "  excluded: true\n", "index.yaml:6"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct wb_reason why = {.text = ""};
        assert_int_equal(wb_index_read(&index, write_index(bad[i][0]), &why), WB_ERR_FORMAT);
        if (!strstr(why.text, bad[i][1]))
            fail_msg("'%s' does not contain '%s'", why.text, bad[i][1]);
    }
}

static void appended_entry_is_read_back_and_contents_are_kept(void **state)
{
    (void)state;
    static const char before[] = "# mine\n" HEAD "  notes: no newline at the end";
    const char *const path = write_index(before);
    struct wb_index_entry entry = example("b.wbr");
    entry.excluded = (struct wb_index_exclusion){
        true, true, "O'Neill: \"x\"", "# it's: [odd] \\ \t 5 \xc2\xb5m", "2026-11-23T20:20:00Z"};
    assert_int_equal(wb_index_append(path, &entry), WB_OK);
    char *text;
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    assert_int_equal(strncmp(text, before, sizeof before - 1), 0);
    free(text);
    struct wb_index index;
    assert_int_equal(wb_index_read(&index, path, NULL), WB_OK);
    assert_int_equal(index.n, 2);
    const struct wb_index_entry *const read = wb_index_find(&index, "elsewhere/b.wbr");
    assert_non_null(read);
    assert_string_equal(read->wire, "type1");
    assert_close(read->length, 85.0 * WB_MM, 1e-12);
    assert_int_equal(read->sample, 7);
    assert_int_equal(read->cycles, 2);
    assert_int_equal(read->number, 12);
    assert_true(read->is_virtual);
    assert_string_equal(read->sha256, SHA_B);
    assert_string_equal(read->series, "it's a series");
    assert_string_equal(read->excluded.by, "O'Neill: \"x\"");
    assert_string_equal(read->excluded.reason, "# it's: [odd] \\   5 \xc2\xb5m");
    assert_true(read->excluded.is_repeated);
    wb_index_release(&index);
}

static void index_is_created_and_lists_a_file_once(void **state)
{
    (void)state;
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, WB_INDEX_FILE), WB_OK);
    const struct wb_index_entry first = example("b.wbr"), second = example("c.wbr"),
                                packed = example("b.wbr.zst");
    assert_int_equal(wb_index_append(path, &first), WB_OK);
    assert_int_equal(wb_index_append(path, &second), WB_OK);
    keep_messages();
    assert_int_equal(wb_index_append(path, &packed), WB_ERR_EXISTS);
    assert_message("lists 'b.wbr.zst'");
    struct wb_index index;
    assert_int_equal(wb_index_read(&index, path, NULL), WB_OK);
    assert_int_equal(index.n, 2);
    assert_false(index.entries[1].excluded.is_excluded);
    wb_index_release(&index);
}

static void file_that_cannot_be_appended_is_unchanged(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "recordings:\n  - file: a.wbr\n    wire: type1\n    length_mm: 85\n    sample: 1\n"
        "    sha256: " SHA_A "\n",
        "[{file: a.wbr, wire: type1, length_mm: 85, sample: 1, sha256: " SHA_A "}]\n",
        "  - file: a.wbr\n    wire: type1\n    length_mm: 85\n    sample: 1\n    sha256: " SHA_A
        "\n",
    };
    const struct wb_index_entry entry = example("b.wbr");
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        const char *const path = write_index(texts[i]);
        keep_messages();
        assert_int_equal(wb_index_append(path, &entry), WB_ERR_FORMAT);
        assert_message("index.yaml': an entry for 'b.wbr'");
        char *text;
        assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
        assert_string_equal(text, texts[i]);
        free(text);
    }
}

static void index_beside_a_recording_is_searched_by_name_and_checksum(void **state)
{
    (void)state;
    char recording[WB_PATH];
    struct wb_index_entry entry;
    struct wb_reason why = {.text = ""};
    assert_int_equal(wb_file_join(recording, folder, "a.wbr.zst"), WB_OK);
    assert_false(wb_index_look_up(&entry, recording, SHA_A, &why));
    assert_string_equal(why.text, "");
    write_index(HEAD "  excluded: {by: me, reason: so}\n");
    assert_true(wb_index_look_up(&entry, recording, SHA_A, &why));
    assert_string_equal(entry.excluded.by, "me");
    assert_string_equal(why.text, "");
    assert_false(wb_index_look_up(&entry, recording, SHA_B, &why));
    assert_non_null(strstr(why.text, "(sha256 aaaaaaaaaaaa...)"));
    assert_true(wb_index_look_up(&entry, recording, NULL, &why));
    write_index("- file: a.wbr\n");
    why = (struct wb_reason){.text = ""};
    assert_false(wb_index_look_up(&entry, recording, SHA_A, &why));
    assert_non_null(strstr(why.text, "index.yaml:1"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(exclusion_needs_a_person_and_a_reason, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(appended_entry_is_read_back_and_contents_are_kept,
                                        make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(index_is_created_and_lists_a_file_once, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(file_that_cannot_be_appended_is_unchanged, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(index_beside_a_recording_is_searched_by_name_and_checksum,
                                        make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
