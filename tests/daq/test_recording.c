/* Undamaged recordings: round trip, order of time, closing to a single file, compression, reading
 * from a read-only folder. */
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/wait.h>

#include "base/hash.h"
#include "daq/recording/recording_private.h"
#include "tests/compress.h"
#include "tests/daq/recording_fixture.h"

static void written_recording_reads_back_exactly(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 400);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_true(wb_recording_is_complete(recording));
    assert_int_equal(wb_recording_n_streams(recording), 3);
    const struct wb_recording_stream *stream = wb_recording_stream_at(recording, 2);
    assert_int_equal(stream->id, 2);
    assert_int_equal(stream->role, WB_ROLE_STAGE);
    assert_string_equal(stream->address, "pty:/dev/pts/2");
    assert_string_equal(stream->protocol, "grbl");
    assert_string_equal(wb_recording_stream_settings(recording, 0), "unit: g");
    assert_null(wb_recording_stream_at(recording, 3));
    assert_null(wb_recording_stream_at(recording, -1));
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, 1200);
    assert_int_equal(tally.damaged, 0);
    assert_true(tally.exact);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(bench->messages, 0);
}

static enum wb_status keep_event(void *context, const struct wb_event *event)
{
    struct wb_event *kept = context;
    kept[0] = kept[1];
    kept[1] = *event;
    return WB_OK;
}

static enum wb_status keep_clock(void *context, const struct wb_clock_row *row)
{
    *(struct wb_clock_row *)context = *row;
    return WB_OK;
}

static enum wb_status join_meta(void *context, const char *key, const char *value)
{
    char *text = context;
    size_t n = strlen(text);
    if (strcmp(key, WB_RECORDING_DIGEST) != 0)
        snprintf(text + n, 200 - n, "%s=%s;", key, strcmp(key, "closed") == 0 ? "UTC" : value);
    return WB_OK;
}

static void meta_events_and_clock_rows_read_back(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, 1);
    assert_int_equal(wb_recording_set_meta(recording, "operator", "B. Second"), WB_OK);
    assert_int_equal(wb_recording_set_meta(recording, "a", "\xc3\xa9\n2"), WB_OK);
    /* Written later, but earlier in time. */
    assert_int_equal(wb_recording_append_event(recording, 5, "mark", "first"), WB_OK);
    assert_int_equal(wb_recording_append_clock(recording, 1, INT64_MAX, (double)NAN, -3), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);

    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    char joined[200] = "";
    assert_int_equal(wb_recording_each_meta(recording, join_meta, joined), WB_OK);
    assert_string_equal(joined, "a=\xc3\xa9\n2;closed=UTC;operator=B. Second;");
    char *value = NULL;
    assert_int_equal(wb_recording_meta(recording, "operator", &value), WB_OK);
    assert_string_equal(value, "B. Second");
    free(value);
    value = NULL;
    assert_int_equal(wb_recording_meta(recording, "no such key", &value), WB_ERR_NOT_FOUND);
    assert_null(value);
    assert_int_equal(bench->messages, 0);
    struct wb_event events[2] = {{0}};
    assert_int_equal(wb_recording_each_event(recording, keep_event, events), WB_OK);
    assert_string_equal(events[0].text, "first");
    assert_int_equal(events[0].t_ns, 5);
    assert_string_equal(events[1].kind, "tare");
    struct wb_clock_row row = {0};
    assert_int_equal(wb_recording_each_clock(recording, keep_clock, &row), WB_OK);
    assert_int_equal(row.t_host_ns, INT64_MAX);
    assert_int_equal(row.rtt_ns, -3);
    assert_true(isnan(row.t_device));
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void chunks_written_out_of_order_are_visited_in_time_order(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, 0);
    for (int64_t seq = 99; seq >= 0; seq--) {
        for (int stream = 2; stream >= 0; stream--) {
            uint8_t bytes[300];
            size_t n = bench_bytes(stream, seq, bytes);
            assert_int_equal(wb_recording_append_chunk(recording, stream, seq,
                                                       bench_time(stream, seq), bytes, n),
                             WB_OK);
        }
    }
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, 300);
    assert_true(tally.exact);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static enum wb_status stop_at_third(void *context, const struct wb_chunk *chunk)
{
    (void)chunk;
    return ++*(int *)context == 3 ? WB_ERR_BUSY : WB_OK;
}

static void error_of_a_visitor_ends_the_walk(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 10);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    int visited = 0;
    assert_int_equal(wb_recording_each_chunk(recording, stop_at_third, &visited), WB_ERR_BUSY);
    assert_int_equal(visited, 3);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void recording_is_never_overwritten(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 3);
    char before[65], after[65];
    assert_int_equal(wb_hash_file(bench->path, before), WB_OK);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_ERR_EXISTS);
    assert_null(recording);
    assert_non_null(strstr(bench->message, "never overwritten"));
    assert_int_equal(wb_hash_file(bench->path, after), WB_OK);
    assert_string_equal(before, after);
    /* A write-ahead log that remains of an earlier recording of this name is not overwritten
     * either. */
    char other[128], wal[136];
    snprintf(other, sizeof other, "%s/other.wbr", bench->folder);
    snprintf(wal, sizeof wal, "%s-wal", other);
    FILE *file = fopen(wal, "w");
    assert_non_null(file);
    fclose(file);
    assert_int_equal(wb_recording_create(&recording, other), WB_ERR_EXISTS);
    assert_non_null(strstr(bench->message, "other.wbr-wal"));
}

static void closed_recording_is_a_single_file_with_application_id(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, 20);
    assert_true(bench_exists(bench->folder, "test.wbr-wal"));
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_false(bench_exists(bench->folder, "test.wbr-wal"));
    assert_false(bench_exists(bench->folder, "test.wbr-shm"));
    uint8_t header[100];
    int descriptor = open(bench->path, O_RDONLY);
    assert_int_equal(read(descriptor, header, sizeof header), sizeof header);
    close(descriptor);
    assert_memory_equal(header + 68, "WBR1", 4);
    assert_int_equal(header[63], WB_RECORDING_SCHEMA);
    assert_int_equal(header[18], 1); /* rollback journal, not WAL */
    assert_int_equal(header[19], 1);
}

/* The bytes of each row are written here as docs/file-formats.md describes them. */
static void recording_is_readable_with_sqlite_and_has_zlib_checksums(void **state)
{
    static const char first[] = "stream\0"
                                "\1\0\0\0\0\0\0\0"
                                "\0\0\0\0\0\0\0\0"
                                "\4\0\0\0\0\0\0\0load"
                                "\2\0\0\0\0\0\0\0m:"
                                "\7\0\0\0\0\0\0\0generic"
                                "\0\0\0\0\0\0\0\0";
    static const char second[] = "chunk\0"
                                 "\2\0\0\0\0\0\0\0"
                                 "\0\0\0\0\0\0\0\0"
                                 "\3\0\0\0\0\0\0\0"
                                 "\376\377\377\377\377\377\377\377"
                                 "\11\0\0\0\0\0\0\000123456789";
    static const char third[] = "clock\0"
                                "\3\0\0\0\0\0\0\0"
                                "\1\0\0\0\0\0\0\0"
                                "\0\1\0\0\0\0\0\0"
                                "\0\0\0\0\0\0\370\077"
                                "\5\0\0\0\0\0\0\0";
    static const struct {
        const char *bytes;
        size_t n;
        const char *select;
    } rows[] = {
        {first, sizeof first - 1, "SELECT crc32, chain FROM stream WHERE n = 1"},
        {second, sizeof second - 1, "SELECT crc32, chain FROM chunk WHERE n = 2"},
        {third, sizeof third - 1, "SELECT crc32, chain FROM clock WHERE n = 3"},
    };
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    int id;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    assert_int_equal(wb_recording_add_stream(recording, WB_ROLE_LOAD, "m:", "generic", "", &id),
                     WB_OK);
    assert_int_equal(wb_recording_append_chunk(recording, 0, 3, -2, "123456789", 9), WB_OK);
    assert_int_equal(wb_recording_append_clock(recording, 1, 256, 1.5, 5), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    sqlite3 *db = NULL;
    sqlite3_stmt *statement = NULL;
    assert_int_equal(sqlite3_open_v2(bench->path, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
    uint32_t chain = 0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const uint32_t crc = wb_recording_crc32(rows[i].bytes, rows[i].n);
        uint8_t both[8];
        for (int k = 0; k < 4; k++) {
            both[k] = (uint8_t)(chain >> 8 * k);
            both[4 + k] = (uint8_t)(crc >> 8 * k);
        }
        chain = wb_recording_crc32(both, sizeof both);
        assert_int_equal(sqlite3_prepare_v2(db, rows[i].select, -1, &statement, NULL), SQLITE_OK);
        assert_int_equal(sqlite3_step(statement), SQLITE_ROW);
        assert_int_equal(sqlite3_column_int64(statement, 0), crc);
        assert_int_equal(sqlite3_column_int64(statement, 1), chain);
        sqlite3_finalize(statement);
    }
    sqlite3_close(db);
    /* The check value of CRC-32/ISO-HDLC. */
    assert_int_equal(wb_recording_crc32("123456789", 9), 0xcbf43926);
}

/* Hashing an open recording gives the checksum of the file and does not disturb later reading. */
static void assert_hash_of_open_recording(const char *path, const char *expected)
{
    struct wb_recording *recording;
    struct bench_tally tally;
    char sum[65];
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_recording_hash(recording, sum), WB_OK);
    assert_string_equal(sum, expected);
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_true(tally.exact);
    assert_int_equal(wb_recording_hash(recording, sum), WB_OK);
    assert_string_equal(sum, expected);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void compressed_recording_reads_the_same_and_has_the_same_checksum(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 300);
    char packed[128], again[128], plain_sum[65], packed_sum[65], file_sum[65];
    snprintf(packed, sizeof packed, "%s/test.wbr.zst", bench->folder);
    snprintf(again, sizeof again, "%s/again.wbr.zst", bench->folder);
    assert_int_equal(compress_recording(bench->path, packed), WB_OK);
    assert_int_equal(compress_recording(bench->path, again), WB_OK);
    assert_int_equal(wb_recording_sha256(bench->path, plain_sum, NULL), WB_OK);
    assert_int_equal(wb_recording_sha256(packed, packed_sum, NULL), WB_OK);
    assert_string_equal(plain_sum, packed_sum);
    assert_hash_of_open_recording(bench->path, plain_sum);
    assert_hash_of_open_recording(packed, plain_sum);
    assert_int_equal(wb_hash_file(bench->path, file_sum), WB_OK);
    assert_string_equal(plain_sum, file_sum);
    /* Compression is reproducible, and the file is smaller. */
    assert_int_equal(wb_hash_file(packed, packed_sum), WB_OK);
    assert_int_equal(wb_hash_file(again, file_sum), WB_OK);
    assert_string_equal(packed_sum, file_sum);
    struct stat plain_there, packed_there;
    assert_int_equal(stat(bench->path, &plain_there), 0);
    assert_int_equal(stat(packed, &packed_there), 0);
    assert_true(packed_there.st_size < plain_there.st_size);

    /* The temporary file is already unlinked while the recording is open. */
    setenv("TMPDIR", bench->folder, 1);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, packed), WB_OK);
    unsetenv("TMPDIR");
    char command[128];
    snprintf(command, sizeof command, "test $(ls %s | wc -l) -eq 3", bench->folder);
    assert_int_equal(system(command), 0);
    assert_true(wb_recording_is_complete(recording));
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, 900);
    assert_true(tally.exact);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* Runs the function as an ordinary user, since root may write anywhere. */
static int as_ordinary_user(int (*function)(struct bench *), struct bench *bench)
{
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (getuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0))
            _exit(99);
        _exit(function(bench));
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static int read_in_read_only_folder(struct bench *bench)
{
    char probe[128];
    snprintf(probe, sizeof probe, "%s/probe", bench->folder);
    if (open(probe, O_CREAT | O_WRONLY, 0600) >= 0)
        return 2; /* the folder is not read-only: the test would be meaningless */
    struct wb_recording *recording = NULL;
    if (wb_recording_open(&recording, bench->path) != WB_OK)
        return 3;
    struct bench_tally tally;
    if (bench_walk(recording, &tally) != WB_OK || tally.chunks != 150 || !tally.exact)
        return 4;
    return wb_recording_close(recording) == WB_OK ? 0 : 5;
}

static void closed_recording_is_read_from_a_read_only_folder(void **state)
{
    struct bench *bench = *state;
    bench_make(bench->path, 50);
    assert_int_equal(chmod(bench->path, 0444), 0);
    assert_int_equal(chmod(bench->folder, 0555), 0);
    assert_int_equal(as_ordinary_user(read_in_read_only_folder, bench), 0);
    assert_int_equal(chmod(bench->folder, 0755), 0);
}

static void unclosed_recording_is_read_from_a_read_only_folder(void **state)
{
    struct bench *bench = *state;
    char live[128], wal[136], copy_of_wal[136];
    snprintf(live, sizeof live, "%s/live.wbr", bench->folder);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_create(&recording, live), WB_OK);
    bench_fill(recording, 50);
    /* A copy made during recording is in the same state as the file after a crash. */
    snprintf(wal, sizeof wal, "%s-wal", live);
    snprintf(copy_of_wal, sizeof copy_of_wal, "%s-wal", bench->path);
    bench_copy(live, bench->path);
    bench_copy(wal, copy_of_wal);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(chmod(bench->path, 0444), 0);
    assert_int_equal(chmod(copy_of_wal, 0444), 0);
    assert_int_equal(chmod(bench->folder, 0555), 0);
    assert_int_equal(as_ordinary_user(read_in_read_only_folder, bench), 0);
    assert_int_equal(chmod(bench->folder, 0755), 0);
}

static void recording_can_be_read_while_it_is_written(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL, *reader = NULL;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, 30);
    reader = bench_open(bench->path, false, 90);
    assert_int_equal(wb_recording_close(reader), WB_OK);
    assert_int_equal(wb_recording_append_event(recording, 1, "mark", "after the reader"), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_false(bench_exists(bench->folder, "test.wbr-wal"));
}

static void path_with_special_characters_is_opened(void **state)
{
    struct bench *bench = *state;
    char path[160];
    snprintf(path, sizeof path, "%s/50%% #1? a&b.wbr", bench->folder);
    bench_make(path, 5);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    struct bench_tally tally;
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, 15);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void wrong_use_is_rejected(void **state)
{
    struct bench *bench = *state;
    struct wb_recording *recording = NULL;
    char missing[128];
    snprintf(missing, sizeof missing, "%s/no/such/folder.wbr", bench->folder);
    assert_int_equal(wb_recording_create(&recording, missing), WB_ERR_NOT_FOUND);
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    assert_int_equal(wb_recording_append_chunk(recording, 0, 0, 0, "x", 1), WB_ERR_ARGUMENT);
    assert_int_equal(wb_recording_append_event(recording, 0, "mark", "still works"), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(wb_recording_append_event(recording, 0, "mark", "no"), WB_ERR_ARGUMENT);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(wb_recording_close(NULL), WB_OK);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(written_recording_reads_back_exactly),
        FACT(meta_events_and_clock_rows_read_back),
        FACT(chunks_written_out_of_order_are_visited_in_time_order),
        FACT(error_of_a_visitor_ends_the_walk),
        FACT(recording_is_never_overwritten),
        FACT(closed_recording_is_a_single_file_with_application_id),
        FACT(recording_is_readable_with_sqlite_and_has_zlib_checksums),
        FACT(compressed_recording_reads_the_same_and_has_the_same_checksum),
        FACT(closed_recording_is_read_from_a_read_only_folder),
        FACT(unclosed_recording_is_read_from_a_read_only_folder),
        FACT(recording_can_be_read_while_it_is_written),
        FACT(path_with_special_characters_is_opened),
        FACT(wrong_use_is_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
