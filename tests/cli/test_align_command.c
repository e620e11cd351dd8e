/* `wirebench align` and `wirebench quicklook` on made-up recordings: outputs, messages, exit codes.
 * WIREBENCH_BINARY is the path of the tool. */
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "base/file.h"
#include "base/json.h"
#include "daq/recording/recording_private.h"
#include "tests/analysis/synthetic.h"
#include "tests/compress.h"
#include "tests/schemas.h"

struct outcome {
    int code;
    char *out, *err; /* owned */
};

static int start(void **state)
{
    if (make_folder(state) != 0 || setenv("DIR", folder, 1) != 0)
        return -1;
    char path[128];
    struct syn syn;
    syn_default(&syn);
    syn.travel = 8e-3;
    snprintf(path, sizeof path, "%s/whole.wbr", folder);
    syn_record(&syn, path);
    syn_default(&syn);
    syn.travel = 8e-3;
    syn.gap_from = 4.0;
    syn.gap_until = 6.0;
    snprintf(path, sizeof path, "%s/gap.wbr", folder);
    syn_record(&syn, path);
    syn_default(&syn);
    syn.travel = 8e-3;
    syn.no_tare = true;
    snprintf(path, sizeof path, "%s/no-tare.wbr", folder);
    syn_record(&syn, path);
    return 0;
}

static char *read_whole(const char *name)
{
    char path[WB_PATH], *bytes;
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_read(path, &bytes, NULL), WB_OK);
    return bytes;
}

/* Runs `wirebench ARGUMENTS` in a shell, in which $DIR is the folder. */
static struct outcome tool(const char *arguments)
{
    const char *const binary = getenv("WIREBENCH_BINARY");
    char command[1024];
    if (!binary)
        fail_msg("WIREBENCH_BINARY is not set: run this test through meson");
    snprintf(command, sizeof command, "'%s' %s > $DIR/.out 2> $DIR/.err", binary, arguments);
    const int status = system(command);
    assert_true(WIFEXITED(status));
    return (struct outcome){
        .code = WEXITSTATUS(status), .out = read_whole(".out"), .err = read_whole(".err")};
}

static void expect(const char *arguments, int code, const char *out, const char *err)
{
    struct outcome outcome = tool(arguments);
    if (outcome.code != code || !strstr(outcome.out, out) || !strstr(outcome.err, err))
        fail_msg("'%s': exit code %d, stdout '%s', stderr '%s'", arguments, outcome.code,
                 outcome.out, outcome.err);
    free(outcome.out);
    free(outcome.err);
}

static bool exists(const char *name)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    return wb_file_exists(path);
}

static void one_recording_becomes_a_dataset(void **state)
{
    (void)state;
    expect("align $DIR/whole.wbr -o $DIR/one", 0, "written to ", "");
    assert_true(exists("one/dataset.json") && exists("one/force_deflection.csv") &&
                exists("one/shape.csv"));
    expect("align $DIR/whole.wbr -o $DIR/one", 1, "", "--force");
    expect("align $DIR/whole.wbr -o $DIR/one --force", 0, "virtual rig", "");
}

static void several_become_a_folder_each(void **state)
{
    (void)state;
    /* One of them has a gap: all are written, and the exit code says it. */
    expect("align $DIR/whole.wbr $DIR/gap.wbr -o $DIR/several", 3, "gap.wbr", "in the rows");
    assert_true(exists("several/whole/dataset.json") && exists("several/gap/dataset.json"));
    expect("align $DIR/whole.wbr $DIR/whole.wbr -o $DIR/twice", 1, "", "two recordings");
    assert_false(exists("twice"));
}

static void json_is_one_object_with_units(void **state)
{
    (void)state;
    struct outcome outcome = tool("align $DIR/whole.wbr -o $DIR/json --json");
    struct wb_json *root;
    double length, bow;
    assert_int_equal(outcome.code, 0);
    assert_int_equal(wb_json_parse(&root, outcome.out, "stdout"), WB_OK);
    const struct wb_json *const entry = wb_json_item(wb_json_get(root, "datasets"), 0);
    assert_true(wb_json_get_number(entry, "length_mm", &length));
    assert_true(wb_json_get_number(entry, "bow_mm", &bow));
    assert_close(length, 85.0, 1e-9);
    assert_close(bow, 3.0, 0.4);
    assert_true(wb_json_length(wb_json_get(entry, "corrections")) >= 7);
    wb_json_destroy(root);
    free(outcome.out);
    free(outcome.err);
}

static void compressed_recordings_give_the_same(void **state)
{
    (void)state;
    char plain[WB_PATH], packed[WB_PATH];
    assert_int_equal(wb_file_join(plain, folder, "whole.wbr"), WB_OK);
    assert_int_equal(wb_file_join(packed, folder, "whole.wbr.zst"), WB_OK);
    assert_int_equal(compress_recording(plain, packed), WB_OK);
    expect("align $DIR/whole.wbr -o $DIR/plain", 0, "", "");
    expect("align $DIR/whole.wbr.zst -o $DIR/packed", 0, "", "");
    char *const a = read_whole("plain/force_deflection.csv");
    char *const b = read_whole("packed/force_deflection.csv");
    assert_string_equal(a, b);
    free(a);
    free(b);
}

static void damaged_or_cut_recordings_are_not_complete(void **state)
{
    (void)state;
    char path[WB_PATH], *bytes;
    size_t size;
    assert_int_equal(wb_file_join(path, folder, "damaged.wbr"), WB_OK);
    sqlite3 *db;
    assert_int_equal(system("cp $DIR/whole.wbr $DIR/damaged.wbr"), 0);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, "UPDATE chunk SET crc32 = 0 WHERE stream = 1 AND seq = 50",
                                  NULL, NULL, NULL),
                     SQLITE_OK);
    sqlite3_close(db);
    expect("align $DIR/damaged.wbr -o $DIR/damaged --json", 3, "\"complete\": false",
           "is damaged and left out");
    expect("quicklook $DIR/damaged.wbr -o $DIR/damaged-look", 3, "", "is damaged and left out");

    /* Cut short, the plain file and the compressed one are treated alike. */
    assert_int_equal(wb_file_join(path, folder, "cut.wbr"), WB_OK);
    assert_int_equal(wb_file_join(path, folder, "whole.wbr"), WB_OK);
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    assert_int_equal(wb_file_join(path, folder, "cut.wbr"), WB_OK);
    assert_int_equal(wb_file_write(path, bytes, size * 199 / 200), WB_OK);
    free(bytes);
    expect("align $DIR/cut.wbr -o $DIR/cut", 3, "its end is missing", "is truncated");
    char packed[WB_PATH];
    struct stat there;
    assert_int_equal(wb_file_join(packed, folder, "cut.wbr.zst"), WB_OK);
    assert_int_equal(wb_file_join(path, folder, "whole.wbr"), WB_OK);
    assert_int_equal(compress_recording(path, packed), WB_OK);
    assert_int_equal(stat(packed, &there), 0);
    assert_int_equal(truncate(packed, there.st_size * 199 / 200), 0);
    expect("align $DIR/cut.wbr.zst -o $DIR/cut-packed", 3, "its end is missing", "is truncated");
}

static void settings_reach_the_rows(void **state)
{
    (void)state;
    expect("align $DIR/whole.wbr -o $DIR/slow --row-rate 5 --shape-step-mm 2", 0, "", "");
    char *const rows = read_whole("slow/force_deflection.csv");
    int n = 0;
    for (const char *c = rows; *c; c++)
        n += *c == '\n';
    assert_true(n > 80 && n < 95);
    free(rows);
}

static void quicklook_draws_one_recording(void **state)
{
    (void)state;
    expect("quicklook $DIR/whole.wbr -o $DIR/look", 0, "largest force", "");
    assert_true(exists("look/force_deflection.svg") && exists("look/force_deflection.png") &&
                exists("look/force_deflection.pdf") && exists("look/shapes.svg") &&
                exists("look/summary.txt") && exists("look/force_deflection.csv"));
    expect("quicklook $DIR/whole.wbr -o $DIR/look", 1, "", "--force");
    expect("quicklook $DIR/whole.wbr -o $DIR/look --force --json", 0,
           "\"largest_deflection_mm\": ", "");
    expect("quicklook $DIR/whole.wbr -o $DIR/look --force --json", 0, "\"largest_force_N\": ", "");
    expect("quicklook $DIR/gap.wbr -o $DIR/look --force", 3, "in the rows", "");
}

static void an_error_is_reported_once(void **state)
{
    (void)state;
    expect("align $DIR/no-tare.wbr -o $DIR/none", 1, "", "no tare");
    assert_false(exists("none"));
    expect("align $DIR/nothing.wbr -o $DIR/none", 1, "", "nothing.wbr");
    expect("align $DIR/.out -o $DIR/none", 1, "", "is not a recording");
    expect("quicklook $DIR/nothing.wbr -o $DIR/none", 1, "", "nothing.wbr");
    expect("align -o $DIR/none", 2, "", "at least one recording");
    expect("align $DIR/whole.wbr", 2, "", "-o DATASET");
    expect("align $DIR/whole.wbr -o $DIR/none --row-rate fast", 2, "", "--row-rate");
    expect("quicklook $DIR/whole.wbr $DIR/gap.wbr -o $DIR/none", 2, "", "gap.wbr");
    expect("quicklook -o $DIR/none", 2, "", "name a recording");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_recording_becomes_a_dataset),
        cmocka_unit_test(several_become_a_folder_each),
        cmocka_unit_test(json_is_one_object_with_units),
        cmocka_unit_test(compressed_recordings_give_the_same),
        cmocka_unit_test(damaged_or_cut_recordings_are_not_complete),
        cmocka_unit_test(settings_reach_the_rows),
        cmocka_unit_test(quicklook_draws_one_recording),
        cmocka_unit_test(an_error_is_reported_once),
    };
    return cmocka_run_group_tests(tests, start, check_and_remove_folder);
}
