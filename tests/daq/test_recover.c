/* Recovery of damaged recordings: recovered data are correct and at least those that SQLite reads,
 * and the damaged files are not changed. */
#include <fcntl.h>

#include "base/file.h"
#include "base/hash.h"
#include "daq/recording/recording_salvage.h"
#include "daq/recording/recover.h"
#include "daq/recording/survey.h"
#include "tests/compress.h"
#include "tests/daq/old_recording.h"
#include "tests/daq/recording_fixture.h"
#include "tests/trials.h"

enum {
    CHUNKS = 400, /* of each stream */
    PAGE = 4096,
    FRAME = 24 + PAGE
};

/* The file of a case, and its result. */
struct names {
    char in[128], log[136], out[128];
};

static struct names name(const struct bench *bench)
{
    struct names names;
    snprintf(names.in, sizeof names.in, "%s/damaged.wbr", bench->folder);
    snprintf(names.log, sizeof names.log, "%s-wal", names.in);
    snprintf(names.out, sizeof names.out, "%s/new.wbr", bench->folder);
    return names;
}

/* A recording that is not closed, as a crash leaves it: the file and its log. */
static struct names make_unclosed(const struct bench *bench)
{
    const struct names names = name(bench);
    char log[128];
    struct wb_recording *recording = NULL;
    snprintf(log, sizeof log, "%s-wal", bench->path);
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, CHUNKS);
    bench_copy(bench->path, names.in);
    bench_copy(log, names.log);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(unlink(bench->path), 0);
    return names;
}

static struct names make_closed(const struct bench *bench)
{
    const struct names names = name(bench);
    bench_make(names.in, CHUNKS);
    return names;
}

/* Number of correct chunks that SQLite reads. A damaged tree may contain a chunk twice. */
static int64_t read_chunks(const char *path)
{
    struct wb_recording *recording = NULL;
    struct bench_tally tally = {0};
    if (wb_recording_open(&recording, path) != WB_OK)
        return 0;
    (void)!bench_walk(recording, &tally);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    return tally.next[0] + tally.next[1] + tally.next[2] - tally.missing;
}

/* Recovers; checks that the new recording is consistent and contains only data that were written.
 * Returns its number of chunks. */
static int64_t recover(const struct names *names, struct wb_recover *found)
{
    struct wb_recording *recording = NULL;
    struct bench_tally tally;
    struct wb_recording_check check;
    unlink(names->out);
    assert_int_equal(wb_recover_run(names->in, names->out, found, NULL), WB_OK);
    assert_int_equal(wb_recording_open(&recording, names->out), WB_OK);
    assert_true(wb_recording_is_complete(recording));
    assert_int_equal(wb_recording_check(recording, &check), WB_OK);
    assert_true(check.is_closed && check.digest_fits && check.damaged == 0 && check.lost == 0);
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_true(tally.exact);
    assert_int_equal(tally.damaged, 0);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    return tally.chunks;
}

static void flip(const char *path, off_t at, int bit)
{
    const int descriptor = open(path, O_RDWR);
    uint8_t byte;
    assert_true(descriptor >= 0);
    assert_int_equal(pread(descriptor, &byte, 1, at), 1);
    byte = (uint8_t)(byte ^ 1u << bit);
    assert_int_equal(pwrite(descriptor, &byte, 1, at), 1);
    close(descriptor);
}

static off_t size_of(const char *path)
{
    struct stat there;
    assert_int_equal(stat(path, &there), 0);
    return there.st_size;
}

static void closed_recording_is_recovered_completely(void **state)
{
    const struct names names = make_closed(*state);
    struct wb_recover found;
    assert_int_equal(recover(&names, &found), 3 * CHUNKS);
    assert_true(wb_recover_is_whole(&found));
    assert_true(found.is_protected && found.is_end_known);
    char text[200], *value = NULL;
    wb_recover_missing(&found, text, sizeof text);
    assert_string_equal(text, "");
    /* All other rows, and the origin, are present. */
    struct wb_recording *recording = NULL;
    struct wb_survey survey;
    assert_int_equal(wb_recording_open(&recording, names.out), WB_OK);
    assert_int_equal(wb_recording_n_streams(recording), 3);
    assert_string_equal(wb_recording_stream_settings(recording, 2), "axis: X");
    assert_int_equal(wb_recording_meta(recording, "operator", &value), WB_OK);
    assert_string_equal(value, "A. Tester");
    free(value);
    assert_int_equal(wb_recording_meta(recording, WB_RECOVER_META_FROM, &value), WB_OK);
    assert_string_equal(value, "damaged.wbr");
    free(value);
    assert_int_equal(wb_survey_run(recording, false, &survey), WB_OK);
    assert_int_equal(survey.events, 1);
    assert_int_equal(survey.clock_rows, 1);
    assert_true(survey.is_recovered);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void damaged_files_stay_as_they_were(void **state)
{
    const struct bench *const bench = *state;
    const struct names names = make_unclosed(bench);
    struct wb_recover found;
    char before[2][WB_SHA256_TEXT], after[2][WB_SHA256_TEXT], command[256];
    assert_int_equal(wb_hash_file(names.in, before[0]), WB_OK);
    assert_int_equal(wb_hash_file(names.log, before[1]), WB_OK);
    assert_int_equal(wb_recover_run(names.in, names.out, &found, NULL), WB_OK);
    assert_int_equal(wb_hash_file(names.in, after[0]), WB_OK);
    assert_int_equal(wb_hash_file(names.log, after[1]), WB_OK);
    assert_memory_equal(before, after, sizeof before);
    /* No other file was created. */
    snprintf(command, sizeof command, "test $(ls %s | wc -l) = 3", bench->folder);
    assert_int_equal(system(command), 0);
}

static void unclosed_recording_is_recovered_with_its_log(void **state)
{
    const struct names names = make_unclosed(*state);
    struct wb_recover found;
    char text[256];
    int at = 0;
    assert_int_equal(recover(&names, &found), 3 * CHUNKS);
    assert_int_equal(found.missing, 0);
    /* It is unknown whether more was written, which the new recording states. */
    assert_false(found.is_end_known);
    assert_false(wb_recover_is_whole(&found));
    struct wb_recording *recording = NULL;
    struct wb_survey survey;
    assert_int_equal(wb_recording_open(&recording, names.out), WB_OK);
    assert_int_equal(wb_survey_run(recording, false, &survey), WB_OK);
    assert_false(wb_survey_is_whole(&survey));
    bool reported = false;
    while (wb_survey_problem(&survey, &at, text, sizeof text))
        reported |= strstr(text, "recovered from a damaged file; missing: ") != NULL;
    assert_true(reported);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void missing_log_is_reported(void **state)
{
    struct bench *const bench = *state;
    const struct names names = make_unclosed(bench);
    struct wb_recording *recording = NULL;
    struct wb_recover found;
    assert_int_equal(unlink(names.log), 0);
    bench->messages = 0;
    assert_int_equal(wb_recording_open(&recording, names.in), WB_OK);
    assert_non_null(strstr(bench->message, "'damaged.wbr-wal' is missing"));
    assert_int_equal(wb_recording_close(recording), WB_OK);
    /* The file contains at least the data of its first checkpoint. */
    if (wb_recover_run(names.in, names.out, &found, NULL) == WB_OK)
        assert_true(found.is_log_missing);
}

/* A checkpoint per second: the file without its log lacks only the last second. */
static void checkpoints_move_flushed_data_from_the_log_to_the_file(void **state)
{
    struct bench *const bench = *state;
    const struct names names = name(bench);
    struct wb_recording *recording = NULL;
    struct wb_recover found;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, CHUNKS);
    recording->checkpoint_ns -= 2 * INT64_C(1000000000);
    assert_int_equal(wb_recording_append_event(recording, 1, "mark", ""), WB_OK);
    assert_int_equal(wb_recording_flush(recording), WB_OK);
    bench_copy(bench->path, names.in);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(recover(&names, &found), 3 * CHUNKS);
    assert_int_equal(found.missing, 0);
}

/* After a damaged frame SQLite finds nothing; here at most one page is lost. */
static void flipped_bit_in_the_log_costs_a_page_at_most(void **state)
{
    struct bench *const bench = *state;
    const struct names names = make_unclosed(bench);
    const off_t size = size_of(names.log);
    struct wb_recover found;
    int64_t least = 3 * CHUNKS, least_read = 3 * CHUNKS;
    uint64_t trials = 0;
    for (off_t at = 7; at < size; at += 9973) {
        flip(names.log, at, (int)(trials % 8));
        bench->messages = 0;
        const int64_t n_read = read_chunks(names.in), n = recover(&names, &found);
        if (n_read < 3 * CHUNKS)
            assert_int_equal(bench->messages, 1);
        assert_true(n >= n_read);
        least = n < least ? n : least;
        least_read = n_read < least_read ? n_read : least_read;
        flip(names.log, at, (int)(trials++ % 8));
    }
    count_trials("A bit flipped in the write-ahead log", trials,
                 "positions: `recover` recovers at least %lld of %d chunks, SQLite alone %lld",
                 (long long)least, 3 * CHUNKS, (long long)least_read);
    assert_true(least > 3 * CHUNKS - 40);
    assert_true(least_read < 3 * CHUNKS / 2);
}

static void truncated_files_and_logs_give_the_intact_rows(void **state)
{
    struct bench *const bench = *state;
    struct names names = make_closed(bench);
    struct wb_recover found;
    uint64_t trials = 0;
    for (off_t n = size_of(names.in) - 1; n > 4 * PAGE; n -= 1777) {
        assert_int_equal(truncate(names.in, n), 0);
        const int64_t n_read = read_chunks(names.in), n_found = recover(&names, &found);
        assert_true(n_found >= n_read);
        /* Damage in bytes without data. */
        if (wb_recover_is_whole(&found))
            assert_int_equal(n_found, 3 * CHUNKS);
        trials++;
    }
    assert_int_equal(unlink(names.in), 0);
    names = make_unclosed(bench);
    for (off_t n = size_of(names.log) - 1; n > FRAME; n -= 7001) {
        assert_int_equal(truncate(names.log, n), 0);
        const int64_t n_read = read_chunks(names.in);
        if (n_read > 0)
            assert_true(recover(&names, &found) >= n_read);
        trials++;
    }
    count_trials("A recording or its log truncated", trials,
                 "lengths: `recover` recovers at least what SQLite reads");
}

static uint64_t random_state;

static uint64_t random_below(uint64_t bound)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return (random_state * UINT64_C(2685821657736338717)) % bound;
}

/* Overwrites a part of the file with zeros, random bytes, or another page of it. */
static void spoil(const char *path)
{
    char *bytes = NULL;
    size_t n, at, length;
    assert_int_equal(wb_file_read(path, &bytes, &n), WB_OK);
    at = random_below(n);
    length = 1 + random_below(3 * PAGE);
    length = length < n - at ? length : n - at;
    switch (random_below(3)) {
    case 0:
        memset(bytes + at, 0, length);
        break;
    case 1:
        for (size_t i = 0; i < length; i++)
            bytes[at + i] = (char)random_below(256);
        break;
    default:
        if (n >= 2 * PAGE)
            memmove(bytes + random_below(n / PAGE) * PAGE, bytes + random_below(n / PAGE) * PAGE,
                    PAGE);
        break;
    }
    assert_int_equal(wb_file_write(path, bytes, n), WB_OK);
    free(bytes);
}

/* Also the header, the schema and the trees' inner pages. */
static void any_damage_leaves_only_what_was_written(void **state)
{
    struct bench *const bench = *state;
    enum {
        TRIALS = 120
    };
    char good[136], good_log[136];
    struct names names = make_unclosed(bench);
    snprintf(good, sizeof good, "%s/good", bench->folder);
    snprintf(good_log, sizeof good_log, "%s/good-log", bench->folder);
    bench_copy(names.in, good);
    bench_copy(names.log, good_log);
    random_state = 4711;
    int64_t least = 3 * CHUNKS;
    for (int i = 0; i < TRIALS; i++) {
        struct wb_recover found;
        bench_copy(good, names.in);
        bench_copy(good_log, names.log);
        for (uint64_t times = 1 + random_below(3); times > 0; times--)
            spoil(random_below(2) ? names.in : names.log);
        const int64_t n_read = read_chunks(names.in);
        unlink(names.out);
        if (wb_recover_run(names.in, names.out, &found, NULL) != WB_OK) {
            fail_msg("case %d: %s", i, bench->message);
            continue;
        }
        const int64_t n = recover(&names, &found);
        if (n < n_read)
            fail_msg("case %d: SQLite reads %lld chunks, recovered are %lld", i, (long long)n_read,
                     (long long)n);
        least = n < least ? n : least;
    }
    count_trials("Pages of a recording and its log overwritten", TRIALS,
                 "cases: at least %lld of %d chunks recovered, none of them wrong",
                 (long long)least, 3 * CHUNKS);
    assert_true(least > CHUNKS);
}

/* Makes a recording whose first rows are common to all, and the others its own. */
static void make_alike(const char *path, int n_chunks, uint8_t own)
{
    struct wb_recording *recording = NULL;
    int id;
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    assert_int_equal(wb_recording_add_stream(recording, WB_ROLE_LOAD, "a", "generic", "", &id),
                     WB_OK);
    for (int i = 0; i < n_chunks; i++) {
        const uint8_t bytes[] = {(uint8_t)i, i < 10 ? 0 : own};
        assert_int_equal(wb_recording_append_chunk(recording, id, i, 1000 + i, bytes, sizeof bytes),
                         WB_OK);
    }
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* The log contains rows of a failed transaction whose numbers were used again: the continued rows
 * must be kept, not those in the log. */
static void rows_that_were_written_anew_count(void **state)
{
    struct bench *const bench = *state;
    const struct names names = name(bench);
    char *file = NULL, *other = NULL;
    size_t n_file, n_other;
    make_alike(names.in, 60, 1);
    make_alike(bench->path, 15, 2);
    assert_int_equal(wb_file_read(names.in, &file, &n_file), WB_OK);
    assert_int_equal(wb_file_read(bench->path, &other, &n_other), WB_OK);
    const size_t n_log = 32 + n_other / PAGE * FRAME;
    uint8_t *const log = calloc(1, n_log);
    for (size_t i = 0; i < n_other / PAGE; i++) {
        log[32 + i * FRAME + 3] = (uint8_t)(i + 1);
        memcpy(log + 32 + i * FRAME + 24, other + i * PAGE, PAGE);
    }
    struct wb_recording_salvage *const salvage =
        wb_recording_salvage_find((const uint8_t *)file, n_file, log, n_log);
    const size_t n = wb_recording_salvage_count(salvage);
    int n_chunks = 0;
    for (size_t i = 0; i < n; i++) {
        struct wb_recording_row row;
        wb_recording_salvage_row(salvage, i, &row);
        if (row.kind != WB_RECORDING_CHUNK)
            continue;
        const uint8_t *const bytes = row.values[WB_RECORDING_CHUNK_BYTES].bytes;
        assert_int_equal(bytes[1], n_chunks < 10 ? 0 : 1);
        n_chunks++;
    }
    assert_int_equal(n_chunks, 60);
    wb_recording_salvage_destroy(salvage);
    free(log);
    free(file);
    free(other);
}

/* Rows of more than a page. */
static void rows_over_several_pages_are_recovered(void **state)
{
    static const size_t sizes[] = {4000, 4040, 4050, 4060, 4070, 4100, 8000, 8150, 20000, 65536};
    const struct names names = name(*state);
    struct wb_recording *recording = NULL;
    static uint8_t bytes[65536];
    int id;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)(i * i >> 3);
    assert_int_equal(wb_recording_create(&recording, names.in), WB_OK);
    assert_int_equal(wb_recording_add_stream(recording, WB_ROLE_LOAD, "a", "generic", "", &id),
                     WB_OK);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        assert_int_equal(wb_recording_append_chunk(recording, id, (int64_t)i, 1000 + (int64_t)i,
                                                   bytes, sizes[i]),
                         WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    struct wb_recover found;
    assert_int_equal(wb_recover_run(names.in, names.out, &found, NULL), WB_OK);
    assert_true(wb_recover_is_whole(&found));
    assert_int_equal(found.streams[0].chunks, sizeof sizes / sizeof sizes[0]);
}

static void older_recordings_are_recovered(void **state)
{
    const struct names names = make_closed(*state);
    struct wb_recover found;
    old_recording_make(names.in);
    assert_int_equal(recover(&names, &found), 3 * CHUNKS);
    assert_false(found.is_protected);
    assert_true(wb_recover_is_whole(&found));
}

static void truncated_compressed_recordings_are_recovered_up_to_their_end(void **state)
{
    struct bench *const bench = *state;
    struct names names = name(bench);
    struct wb_recover found;
    bench_make(bench->path, CHUNKS);
    snprintf(names.in, sizeof names.in, "%s/packed.wbr.zst", bench->folder);
    assert_int_equal(compress_recording(bench->path, names.in), WB_OK);
    assert_int_equal(recover(&names, &found), 3 * CHUNKS);
    assert_true(wb_recover_is_whole(&found));
    assert_int_equal(truncate(names.in, size_of(names.in) / 2), 0);
    unlink(names.out);
    /* A compressed file is decoded in blocks: half of it may contain no row. */
    if (wb_recover_run(names.in, names.out, &found, NULL) == WB_OK)
        assert_false(wb_recover_is_whole(&found));
}

static void other_files_are_rejected(void **state)
{
    struct bench *const bench = *state;
    const struct names names = name(bench);
    static char bytes[3 * PAGE];
    struct wb_recover found;
    struct wb_reason why;
    random_state = 5;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (char)random_below(256);
    bytes[0] = bytes[PAGE] = bytes[2 * PAGE] = 0x0d; /* looks like a page of rows */
    const size_t sizes[] = {0, 1, 100, PAGE, sizeof bytes};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        assert_int_equal(wb_file_write(names.in, bytes, sizes[i]), WB_OK);
        assert_int_equal(wb_recover_run(names.in, names.out, &found, &why), WB_ERR_FORMAT);
        assert_non_null(strstr(why.text, "no row of a recording"));
        assert_false(wb_file_exists(names.out));
        assert_false(bench_exists(bench->folder, "new.wbr.part"));
    }
    assert_int_equal(wb_recover_run("/nowhere/a.wbr", names.out, &found, &why), WB_ERR_NOT_FOUND);
}

static void existing_files_are_not_overwritten(void **state)
{
    const struct names names = make_closed(*state);
    struct wb_recover found;
    struct wb_reason why;
    assert_int_equal(wb_file_write(names.out, "x", 1), WB_OK);
    assert_int_equal(wb_recover_run(names.in, names.out, &found, &why), WB_ERR_EXISTS);
    assert_int_equal(size_of(names.out), 1);
    assert_int_equal(wb_recover_run(names.in, names.in, &found, &why), WB_ERR_EXISTS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(closed_recording_is_recovered_completely),
        FACT(damaged_files_stay_as_they_were),
        FACT(unclosed_recording_is_recovered_with_its_log),
        FACT(missing_log_is_reported),
        FACT(checkpoints_move_flushed_data_from_the_log_to_the_file),
        FACT(flipped_bit_in_the_log_costs_a_page_at_most),
        FACT(truncated_files_and_logs_give_the_intact_rows),
        FACT(any_damage_leaves_only_what_was_written),
        FACT(rows_that_were_written_anew_count),
        FACT(rows_over_several_pages_are_recovered),
        FACT(older_recordings_are_recovered),
        FACT(truncated_compressed_recordings_are_recovered_up_to_their_end),
        FACT(other_files_are_rejected),
        FACT(existing_files_are_not_overwritten),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
