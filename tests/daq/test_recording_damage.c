/* Recordings with problems: killed, truncated, damaged, of another program, on a full disk. Flushed
 * data stay readable, and each failure gives one message. */
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "daq/recording/recording_private.h"
#include "daq/recording/writer_private.h"
#include "tests/compress.h"
#include "tests/daq/gate.h"
#include "tests/daq/recording_fixture.h"

static void run_sql(const char *path, const char *sql)
{
    sqlite3 *db = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(db);
}

static void killed_writer_leaves_what_was_flushed(void **state)
{
    struct bench *bench = *state;
    int flushed[2];
    assert_int_equal(pipe(flushed), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct wb_recording *recording = NULL;
        if (wb_recording_create(&recording, bench->path) != WB_OK)
            _exit(1);
        bench_fill(recording, 500);
        /* Appended and not flushed: this may be lost. */
        uint8_t bytes[300];
        size_t n = bench_bytes(0, 500, bytes);
        if (wb_recording_append_chunk(recording, 0, 500, bench_time(0, 500), bytes, n) != WB_OK)
            _exit(1);
        if (write(flushed[1], "f", 1) != 1)
            _exit(1);
        pause();
        _exit(0);
    }
    char mark;
    close(flushed[1]);
    assert_int_equal(read(flushed[0], &mark, 1), 1);
    close(flushed[0]);
    assert_int_equal(kill(child, SIGKILL), 0);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));

    struct wb_recording *recording = bench_open(bench->path, false, 1500);
    char open_sum[65];
    assert_int_equal(wb_recording_hash(recording, open_sum), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);

    /* Its checksum includes the log. */
    char sum[65], expected[80], command[400];
    assert_int_equal(wb_recording_sha256(bench->path, sum, NULL), WB_OK);
    assert_string_equal(open_sum, sum);
    snprintf(command, sizeof command, "cat %s %s-wal | sha256sum > %s/sum", bench->path,
             bench->path, bench->folder);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command, "%s/sum", bench->folder);
    FILE *file = fopen(command, "r");
    assert_non_null(file);
    assert_non_null(fgets(expected, sizeof expected, file));
    fclose(file);
    assert_memory_equal(sum, expected, 64);
    /* The command of the manual makes it a single file. */
    run_sql(bench->path, "PRAGMA journal_mode=DELETE");
    assert_false(bench_exists(bench->folder, "test.wbr-wal"));
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, 1500);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static off_t size_of(const char *path)
{
    struct stat there;
    assert_int_equal(stat(path, &there), 0);
    return there.st_size;
}

static void truncated_recording_gives_what_is_left(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 500);
    off_t whole = size_of(bench->path);
    int64_t before = 1500;
    for (int percent = 90; percent >= 30; percent -= 20) {
        char cut[128];
        snprintf(cut, sizeof cut, "%s/cut%d.wbr", bench->folder, percent);
        bench_copy(bench->path, cut);
        assert_int_equal(truncate(cut, whole * percent / 100), 0);
        bench->messages = 0;
        struct wb_recording *recording = NULL;
        assert_int_equal(wb_recording_open(&recording, cut), WB_OK);
        assert_int_equal(bench->messages, 1);
        assert_non_null(strstr(bench->message, "is truncated"));
        assert_false(wb_recording_is_complete(recording));
        struct bench_tally tally;
        assert_int_equal(bench_walk(recording, &tally), WB_ERR_DATA);
        assert_true(tally.exact);
        assert_true(tally.chunks > 0 && tally.chunks < before);
        before = tally.chunks;
        assert_int_equal(wb_recording_close(recording), WB_OK);
    }
}

static void file_cut_to_nearly_nothing_is_rejected(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 20);
    static const off_t sizes[] = {0, 15, 99};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        char cut[128];
        snprintf(cut, sizeof cut, "%s/cut%zu.wbr", bench->folder, i);
        bench_copy(bench->path, cut);
        assert_int_equal(truncate(cut, sizes[i]), 0);
        bench->messages = 0;
        struct wb_recording *recording = NULL;
        assert_int_equal(wb_recording_open(&recording, cut), WB_ERR_FORMAT);
        assert_null(recording);
        assert_int_equal(bench->messages, 1);
    }
}

/* Finds the bytes of one known chunk in the file and flips a bit in their middle. */
static void flip_a_bit_of_chunk(const char *path, int stream, int64_t seq)
{
    uint8_t bytes[300];
    size_t n = bench_bytes(stream, seq, bytes);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    static uint8_t all[1 << 20];
    size_t size = fread(all, 1, sizeof all, file);
    const uint8_t *found = memmem(all, size, bytes, n);
    assert_non_null(found);
    long at = (long)(found - all) + (long)n / 2;
    assert_int_equal(fseek(file, at, SEEK_SET), 0);
    assert_int_not_equal(fputc(all[at] ^ 0x10, file), EOF);
    assert_int_equal(fclose(file), 0);
}

static void flipped_bit_is_found_by_the_crc_and_only_there(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 100);
    flip_a_bit_of_chunk(bench->path, 1, 47);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, 300);
    assert_int_equal(tally.damaged, 1);
    assert_true(tally.exact);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void truncated_compressed_recording_gives_what_is_left(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 3000);
    char packed[128], hex[65];
    snprintf(packed, sizeof packed, "%s/cut.wbr.zst", bench->folder);
    assert_int_equal(compress_recording(bench->path, packed), WB_OK);
    assert_int_equal(truncate(packed, size_of(packed) / 2), 0);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, packed), WB_OK);
    assert_false(wb_recording_is_complete(recording));
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_ERR_DATA);
    assert_true(tally.exact);
    assert_true(tally.chunks > 0 && tally.chunks < 9000);
    char open_hex[65];
    assert_int_equal(wb_recording_hash(recording, open_hex), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    /* One message in total; the hash is that of the remaining data. */
    assert_int_equal(wb_recording_sha256(packed, hex, NULL), WB_OK);
    assert_string_equal(open_hex, hex);
    assert_non_null(strstr(bench->message, "is truncated"));
    assert_null(strstr(bench->message, "table "));
}

static void other_files_are_rejected_with_the_reason(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    char path[128];
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(bench->message, bench->path));

    snprintf(path, sizeof path, "%s/other.db", bench->folder);
    run_sql(path, "CREATE TABLE t(x)");
    assert_int_equal(wb_recording_open(&recording, path), WB_ERR_FORMAT);
    assert_non_null(strstr(bench->message, "another program"));

    snprintf(path, sizeof path, "%s/text.wbr", bench->folder);
    FILE *file = fopen(path, "w");
    for (int i = 0; i < 100; i++)
        fprintf(file, "time,force\n");
    fclose(file);
    assert_int_equal(wb_recording_open(&recording, path), WB_ERR_FORMAT);
    assert_non_null(strstr(bench->message, "is not a recording"));

    bench_make(bench->path, 1);
    run_sql(bench->path, "PRAGMA user_version=3");
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_ERR_UNSUPPORTED);
    assert_non_null(strstr(bench->message, "newer"));
    assert_int_equal(wb_recording_open(&recording, bench->folder), WB_ERR_IO);
}

static void missing_table_is_reported_and_the_others_are_read(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 10);
    run_sql(bench->path, "DROP TABLE chunk");
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_ERR_DATA);
    assert_non_null(strstr(bench->message, "chunk"));
    char *value = NULL;
    assert_int_equal(wb_recording_meta(recording, "operator", &value), WB_OK);
    free(value);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static enum wb_status count_event(void *context, const struct wb_event *event)
{
    (void)event;
    ++*(int *)context;
    return WB_OK;
}

static void view_instead_of_a_table_is_not_run(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 10);
    /* Would not end if it were executed. */
    run_sql(bench->path, "DROP TABLE event; CREATE VIEW event AS WITH RECURSIVE c(x) AS"
                         " (SELECT 1 UNION ALL SELECT x+1 FROM c) SELECT x AS rowid, x AS t_ns,"
                         " x AS kind, x AS text FROM c");
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    int events = 0;
    assert_int_equal(wb_recording_each_event(recording, count_event, &events), WB_ERR_DATA);
    assert_int_equal(events, 0);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* --- full disks --- */

/* Pushes chunks until the writer reports that it cannot keep more, then checks the file. Returns 0
 * if it is correct. */
static int fill_until_full(struct bench *bench, const char *path, const char *reason)
{
    struct wb_recording *recording = NULL;
    if (wb_recording_create(&recording, path) != WB_OK)
        return 10;
    int id;
    for (int i = 0; i < 3; i++) {
        if (wb_recording_add_stream(recording, (enum wb_role)i, "memory:", "generic", "", &id) !=
            WB_OK)
            return 11;
    }
    struct wb_writer_settings settings;
    wb_writer_default_settings(&settings);
    settings.flush_interval_ns = 1000000;
    settings.capacity_bytes = 40000;
    settings.patience_ns = 0;
    struct gate gate = GATE(false);
    settings.before_write = gate_pass;
    settings.context = &gate;
    struct wb_writer *writer = NULL;
    if (wb_writer_start(&writer, recording, &settings) != WB_OK)
        return 12;
    bench->messages = 0;
    int64_t seq = 0;
    char first[sizeof bench->message] = "";
    for (; seq < 200000 && wb_writer_status(writer) == WB_OK; seq++) {
        uint8_t bytes[300];
        int stream = (int)(seq % 3);
        size_t n = bench_bytes(stream, seq / 3, bytes);
        if (!wb_writer_push_chunk(writer, stream, bench_time(stream, seq / 3), bytes, n))
            break;
        if (seq % 50 == 49)
            gate_await_rounds(&gate);
    }
    if (wb_writer_status(writer) != WB_ERR_IO)
        return 13;
    static const uint8_t much[20000];
    if (wb_writer_push_chunk(writer, 0, 0, much, sizeof much) || wb_writer_drops(writer, 0) == 0)
        return 14; /* chunks without space are rejected */
    snprintf(first, sizeof first, "%s", bench->message);
    if (wb_writer_finish(writer) != WB_ERR_IO)
        return 15;
    /* The reason, and at the end the loss. */
    if (bench->messages != 2 || !strstr(first, reason) || !strstr(bench->message, "are lost"))
        return 16;
    if (wb_recording_open(&recording, path) != WB_OK)
        return 17;
    if (wb_recording_is_complete(recording))
        return 18;
    struct bench_tally tally;
    if (bench_walk(recording, &tally) != WB_OK || !tally.exact || tally.damaged)
        return 19;
    /* 100 KiB of space contain at least 60 KiB of chunks. */
    if (tally.chunks < 200)
        return 20;
    return wb_recording_close(recording) == WB_OK ? 0 : 21;
}

static int run_child(int (*function)(struct bench *), struct bench *bench)
{
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        int code = function(bench);
        if (code != 0 && code != 77)
            fprintf(stderr, "child: %d after '%s'\n", code, bench->message);
        _exit(code);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    if (!WIFEXITED(status))
        fail_msg("child ended by signal %d", WTERMSIG(status));
    return WEXITSTATUS(status);
}

static int fill_to_size_limit(struct bench *bench)
{
    struct rlimit limit = {.rlim_cur = 300 << 10, .rlim_max = RLIM_INFINITY};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0)
        return 1;
    return fill_until_full(bench, bench->path, "maximum file size");
}

static void size_limit_is_one_message_and_what_was_flushed_is_readable(void **state)
{
    assert_int_equal(run_child(fill_to_size_limit, *state), 0);
}

static int fill_small_disk(struct bench *bench)
{
    char disk[128], path[160];
    snprintf(disk, sizeof disk, "%s/disk", bench->folder);
    snprintf(path, sizeof path, "%s/full.wbr", disk);
    if (mkdir(disk, 0700) != 0)
        return 1;
    if (unshare(CLONE_NEWNS) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
        return 77;
    if (mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) != 0 ||
        mount("tmpfs", disk, "tmpfs", 0, "size=400k") != 0)
        return 77;
    int code = fill_until_full(bench, path, "disk is full");
    umount(disk);
    return code;
}

static void full_disk_is_one_message_and_what_was_flushed_is_readable(void **state)
{
    int code = run_child(fill_small_disk, *state);
    if (code == 77) {
        print_message("no small disk can be mounted here: not allowed to unshare or mount\n");
        skip();
    }
    assert_int_equal(code, 0);
}

static void place_that_takes_no_files_is_reported(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    assert_int_not_equal(wb_recording_create(&recording, "/proc/no.wbr"), WB_OK);
    assert_null(recording);
    assert_int_equal(bench->messages, 1);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(killed_writer_leaves_what_was_flushed),
        FACT(truncated_recording_gives_what_is_left),
        FACT(file_cut_to_nearly_nothing_is_rejected),
        FACT(flipped_bit_is_found_by_the_crc_and_only_there),
        FACT(truncated_compressed_recording_gives_what_is_left),
        FACT(other_files_are_rejected_with_the_reason),
        FACT(missing_table_is_reported_and_the_others_are_read),
        FACT(view_instead_of_a_table_is_not_run),
        FACT(size_limit_is_one_message_and_what_was_flushed_is_readable),
        FACT(full_disk_is_one_message_and_what_was_flushed_is_readable),
        FACT(place_that_takes_no_files_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
