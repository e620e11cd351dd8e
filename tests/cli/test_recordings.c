/* `wirebench info`, `verify`, `export` and `replay` on recordings: outputs, messages, exit codes.
 * WIREBENCH_BINARY is the path of the tool. */
#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>

#include "base/json.h"
#include "daq/recording/recording_private.h"
#include "tests/compress.h"
#include "tests/daq/recording_fixture.h"
#include "tests/daq/small_test.h"

struct outcome {
    int code;
    char out[65536], err[16384];
};

static void read_all(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t n = fread(text, 1, size - 1, file);
    text[n] = '\0';
    fclose(file);
}

/* Runs `wirebench ARGUMENTS` in a shell, with REC and DIR set to the bench's recording and folder.
 */
static void tool(struct bench *bench, const char *arguments, struct outcome *outcome)
{
    const char *binary = getenv("WIREBENCH_BINARY");
    if (!binary)
        fail_msg("WIREBENCH_BINARY is not set: run this test through meson");
    char command[1024], path[128];
    setenv("REC", bench->path, 1);
    setenv("DIR", bench->folder, 1);
    snprintf(command, sizeof command, "{ %s %s\n} > $DIR/.out 2> $DIR/.err", binary, arguments);
    int status = system(command);
    assert_true(WIFEXITED(status));
    outcome->code = WEXITSTATUS(status);
    snprintf(path, sizeof path, "%s/.out", bench->folder);
    read_all(path, outcome->out, sizeof outcome->out);
    snprintf(path, sizeof path, "%s/.err", bench->folder);
    read_all(path, outcome->err, sizeof outcome->err);
}

static void run_sql(const char *path, const char *sql)
{
    sqlite3 *db = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(db);
}

static int count_lines(const char *text)
{
    int n = 0;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

static struct outcome o;

static int64_t integer(const struct wb_json *object, const char *key)
{
    int64_t value = -1;
    if (!wb_json_get_integer(object, key, &value))
        fail_msg("no integer '%s' in %s", key, o.out);
    return value;
}

static void info_names_the_kind_and_the_virtual_rig(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    tool(bench, "info $REC", &o);
    assert_int_equal(o.code, 0);
    static const char *const words[] = {"from a virtual rig", "wire type1, 85 mm, sample 1",
                                        "small bench",        "A. Tester",
                                        "80 readings",        "48 frames",
                                        "20 reports",         "a \"quoted\", text"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (!strstr(o.out, words[i]))
            fail_msg("'%s' is missing in:\n%s", words[i], o.out);
    }
    tool(bench, "info --json $REC", &o);
    assert_int_equal(o.code, 0);
    struct wb_json *root = NULL;
    assert_int_equal(wb_json_parse(&root, o.out, "info"), WB_OK);
    bool flag = false;
    assert_true(wb_json_get_boolean(root, "virtual_rig", &flag) && flag);
    assert_true(wb_json_get_boolean(root, "whole", &flag) && flag);
    assert_int_equal(wb_json_length(wb_json_get(root, "events")), 2);
    struct wb_json *load = wb_json_item(wb_json_get(root, "streams"), 0);
    assert_int_equal(integer(load, "samples"), SMALL_READINGS);
    double rate = 0.0;
    assert_true(wb_json_get_number(load, "rate_Hz", &rate));
    assert_close(rate, 80.0, 2.0);
    wb_json_destroy(root);
}

static void verify_exits_3_when_something_is_missing_or_damaged(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    tool(bench, "verify $REC", &o);
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.out, "virtual rig, whole, 126 chunks"));
    run_sql(bench->path, "UPDATE chunk SET bytes = x'00' WHERE stream = 1 AND seq = 7;"
                         "DELETE FROM chunk WHERE stream = 0 AND seq = 5");
    tool(bench, "verify $REC", &o);
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.out, "NOT WHOLE"));
    assert_non_null(strstr(o.out, "1 row is damaged (CRC-32): row "));
    assert_non_null(strstr(o.out, "load stream 0: 1 chunk missing in 1 place"));
    tool(bench, "verify --json $REC", &o);
    assert_int_equal(o.code, 3);
    struct wb_json *root = NULL;
    assert_int_equal(wb_json_parse(&root, o.out, "verify"), WB_OK);
    const struct wb_json *first = wb_json_item(wb_json_get(root, "recordings"), 0);
    assert_int_equal(integer(first, "damaged_chunks"), 1);
    assert_int_equal(integer(first, "missing_chunks"), 1);
    assert_int_equal(integer(first, "damaged_rows"), 1);
    assert_int_equal(integer(first, "missing_rows"), 1);
    assert_int_equal(wb_json_length(wb_json_get(first, "problems")), 3);
    wb_json_destroy(root);
    tool(bench, "info $REC", &o);
    assert_int_equal(o.code, 3);
    tool(bench, "replay --rate max $REC", &o);
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.out, "1 damaged chunks"));
    tool(bench, "export $REC -o $DIR/out", &o);
    assert_int_equal(o.code, 3);
}

static void recover_exits_3_when_something_is_missing(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    tool(bench, "recover $REC -o $DIR/whole.wbr", &o);
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.out, "nothing is missing"));
    tool(bench, "recover $REC -o $DIR/whole.wbr", &o);
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "never overwritten"));
    tool(bench, "verify $DIR/whole.wbr", &o);
    assert_int_equal(o.code, 0);
    run_sql(bench->path, "DELETE FROM chunk WHERE stream = 1 AND seq BETWEEN 10 AND 12");
    tool(bench, "recover $REC -o $DIR/less.wbr --json", &o);
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.out, "\"missing_rows\": 3"));
    assert_non_null(strstr(o.out, "stream 1: 3 of 49 chunks"));
    tool(bench, "verify $DIR/less.wbr", &o);
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.out, "recovered from a damaged file; missing: 3 rows"));
    tool(bench, "info $DIR/less.wbr", &o);
    assert_int_equal(o.code, 3);
    tool(bench, "recover /bin/ls -o $DIR/no.wbr", &o);
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "it is not a recording"));
}

static void compressed_recordings_are_taken_everywhere(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    char packed[128];
    snprintf(packed, sizeof packed, "%s/test.wbr.zst", bench->folder);
    assert_int_equal(compress_recording(bench->path, packed), WB_OK);
    tool(bench, "verify $REC $REC.zst | grep -o 'sha256 .*' | sort -u | wc -l", &o);
    assert_string_equal(o.out, "1\n");
    static const char *const commands[] = {"info $REC.zst", "verify $REC.zst",
                                           "replay --rate max $REC.zst",
                                           "export $REC.zst -o $DIR/out"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        tool(bench, commands[i], &o);
        if (o.code != 0)
            fail_msg("%s: exit %d, %s", commands[i], o.code, o.err);
    }
}

static void export_writes_tables_and_overwrites_only_with_force(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    tool(bench, "export $REC -o $DIR/out", &o);
    assert_int_equal(o.code, 0);
    assert_string_equal(o.err, "");
    tool(bench, "export $REC -o $DIR/out", &o);
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "--force"));
    tool(bench, "export $REC -o $DIR/out --force --json", &o);
    assert_int_equal(o.code, 0);
    struct wb_json *root = NULL;
    assert_int_equal(wb_json_parse(&root, o.out, "export"), WB_OK);
    assert_int_equal(integer(root, "load_rows"), SMALL_READINGS);
    assert_int_equal(integer(root, "mocap_rows"), SMALL_FRAMES * SMALL_MARKERS);
    wb_json_destroy(root);
    char path[128];
    snprintf(path, sizeof path, "%s/out/stage.csv", bench->folder);
    read_all(path, o.out, sizeof o.out);
    assert_int_equal(count_lines(o.out), SMALL_REPORTS + 2);
    assert_int_equal(strncmp(o.out, "# virtual rig, test.wbr (sha256 ", 32), 0);
}

static void replay_counts_at_max_and_keeps_pace_otherwise(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    tool(bench, "replay --rate max $REC", &o);
    assert_int_equal(o.code, 0);
    assert_string_equal(o.err, "");
    assert_non_null(strstr(o.out, "virtual rig, 1.0 s, 126 chunks, 80 load readings, 48 mocap "
                                  "frames, 20 stage reports, 0 damaged chunks"));
    tool(bench, "replay --rate 4 --json $REC", &o);
    assert_int_equal(o.code, 0);
    struct wb_json *root = NULL;
    double wall = 0.0;
    assert_int_equal(wb_json_parse(&root, o.out, "replay"), WB_OK);
    assert_true(wb_json_get_number(root, "wall_s", &wall));
    assert_true(wall > 0.24); /* test_replay knows the pace to the nanosecond */
    assert_int_equal(integer(root, "load_readings"), SMALL_READINGS);
    wb_json_destroy(root);
}

static void interrupted_replay_exits_3_with_the_counts_so_far(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    /* At a tenth of its speed the second would take ten. The signal is sent once the tool catches
     * it: before, the process is a copy of the shell, which catches it too. */
    tool(bench,
         "replay --rate 0.1 --json $REC & "
         "until sed -nE 's/^Name:\\t//p; s/^SigCgt:.*(.)$/\\1/p' /proc/$!/status | tr '\\n' ' ' | "
         "grep -q '^wirebench [2367abef]'; do sleep 0.02; done; "
         "kill -INT $!; wait $!; echo code $? >&2; true",
         &o);
    assert_int_equal(o.code, 0);
    if (!strstr(o.err, "code 3"))
        fail_msg("expected code 3: %s", o.err);
}

static void a_truncated_recording_gives_one_warning_and_the_remaining_data(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct stat there;
    assert_int_equal(stat(bench->path, &there), 0);
    assert_int_equal(truncate(bench->path, there.st_size * 7 / 10), 0);
    tool(bench, "replay --rate max $REC", &o);
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.err, "is truncated"));
    tool(bench, "verify $REC", &o);
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.out, "the file is truncated"));
    assert_null(strstr(o.out, "not closed properly"));
    tool(bench, "info $REC", &o);
    assert_int_equal(o.code, 3);
    /* One message, and no second one. */
    const char *const said = strstr(o.err, "wirebench:");
    assert_non_null(said);
    assert_non_null(strstr(said, "MB could be read; use the original"));
    assert_null(strstr(said + 1, "wirebench:"));
}

static void bad_input_is_one_message_and_the_proper_exit_code(void **state)
{
    struct bench *bench = *state;
    static const struct {
        const char *arguments, *word;
        int code;
    } bad[] = {
        {"info", "name a file", 2},
        {"info $REC $REC", "one file", 2},
        {"verify", "name the recordings", 2},
        {"export $REC", "-o DIR", 2},
        {"replay --rate fast $REC", "--rate", 2},
        {"replay --rate 0 $REC", "--rate", 2},
        {"info $DIR/none.wbr", "none.wbr", 1},
        {"verify $DIR/none.wbr", "none.wbr", 1},
        {"export $DIR/none.wbr -o $DIR/out", "none.wbr", 1},
        {"replay $DIR/none.wbr", "none.wbr", 1},
        {"info /etc/passwd", "/etc/passwd", 1},
        {"replay $REC", "no rig file", 1},
        {"export $REC -o $DIR/out", "no rig file", 1},
        {"info --no-such-option $REC", "no-such-option", 2},
    };
    small_make(bench->path, false);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        tool(bench, bad[i].arguments, &o);
        if (o.code != bad[i].code || !strstr(o.err, bad[i].word))
            fail_msg("%s: exit %d (expected %d), '%s'", bad[i].arguments, o.code, bad[i].code,
                     o.err);
        if (bad[i].code == 1)
            assert_int_equal(count_lines(o.err), 1);
    }
}

static void full_output_disk_fails_with_a_message(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    tool(bench, "info $REC > /dev/full; echo code $? >&2; true", &o);
    assert_non_null(strstr(o.err, "code 1"));
    assert_non_null(strstr(o.err, "cannot write to standard output"));
    /* A size limit strikes in the middle of a table: nothing half-written stays. */
    tool(bench, "--version > /dev/null; ulimit -f 8; $WIREBENCH_BINARY export $REC -o $DIR/out",
         &o);
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "mocap.csv"));
    assert_false(bench_exists(bench->folder, "out/mocap.csv"));
    assert_false(bench_exists(bench->folder, "out/mocap.csv.part"));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(info_names_the_kind_and_the_virtual_rig),
        FACT(verify_exits_3_when_something_is_missing_or_damaged),
        FACT(recover_exits_3_when_something_is_missing),
        FACT(compressed_recordings_are_taken_everywhere),
        FACT(export_writes_tables_and_overwrites_only_with_force),
        FACT(replay_counts_at_max_and_keeps_pace_otherwise),
        FACT(interrupted_replay_exits_3_with_the_counts_so_far),
        FACT(a_truncated_recording_gives_one_warning_and_the_remaining_data),
        FACT(bad_input_is_one_message_and_the_proper_exit_code),
        FACT(full_output_disk_fails_with_a_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
