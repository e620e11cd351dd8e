/* The survey finds missing and damaged data, and no other problems; the export writes the readable
 * data. */
#include "base/file.h"
#include "daq/recording/export.h"
#include "daq/recording/replay.h"
#include "daq/recording/survey.h"
#include "tests/daq/old_recording.h"
#include "tests/daq/recording_fixture.h"
#include "tests/daq/small_test.h"

static void look(const char *path, bool decode, struct wb_survey *survey)
{
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_survey_run(recording, decode, survey), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* Exactly one problem is found, and it contains the words. */
static void expect_only(const struct wb_survey *survey, const char *words)
{
    char text[256], other[256];
    int at = 0;
    if (!wb_survey_problem(survey, &at, text, sizeof text))
        fail_msg("no problem found, expected '%s'", words);
    if (!strstr(text, words))
        fail_msg("found '%s', expected '%s'", text, words);
    if (wb_survey_problem(survey, &at, other, sizeof other))
        fail_msg("found '%s' too", other);
    assert_false(wb_survey_is_whole(survey));
}

static void whole_recording_has_no_problem(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_survey survey;
    look(bench->path, true, &survey);
    assert_true(wb_survey_is_whole(&survey));
    assert_true(survey.is_virtual);
    assert_int_equal(survey.n_streams, 3);
    assert_int_equal(survey.streams[0].samples, SMALL_READINGS);
    assert_int_equal(survey.streams[1].samples, SMALL_FRAMES);
    assert_int_equal(survey.streams[2].samples, SMALL_REPORTS);
    assert_close(survey.streams[2].rate, 20.0 / 0.95, 0.01);
    assert_close(wb_seconds_from_ns(survey.streams[2].longest_silence_ns), 0.05, 1e-9);
    assert_int_equal(survey.events, 2);
    assert_int_equal(survey.clock_rows, 1);
    assert_close(wb_survey_duration(&survey), 1.0, 0.02);
}

static void each_kind_of_damage_to_an_old_recording_is_found_and_named(void **state)
{
    static const struct {
        const char *sql, *words;
    } harms[] = {
        {"UPDATE chunk SET crc32 = 0 WHERE stream = 0 AND seq = 4",
         "load stream 0: 1 chunk damaged"},
        {"DELETE FROM chunk WHERE stream = 1 AND seq IN (3, 4, 9)",
         "mocap stream 1: 3 chunks missing in 2 places"},
        {"DELETE FROM chunk WHERE stream = 2 AND seq = 0", "stage stream 2: 1 chunk missing"},
        {"UPDATE chunk SET seq = 3 WHERE stream = 2 AND seq = 19", "repeated or out of order"},
        {"DELETE FROM chunk WHERE stream = 1", "mocap stream 1: no data received"},
        {"DELETE FROM meta WHERE key = 'closed'", "not closed properly"},
        {"DELETE FROM meta WHERE key = 'rig'", "rig file is missing"},
        {"DELETE FROM meta WHERE key = 'specimen'", "specimen file is missing"},
        {"UPDATE meta SET value = '7' WHERE key = 'dropped_chunks'", "(7 chunks)"},
        {"INSERT INTO event VALUES(1, 'drop', 'load stream 0 lost 1 chunks')",
         "drops during recording: 1 "},
        {"INSERT INTO event VALUES(1, 'stream_lost', 'mocap')",
         "a stream was silent for too long 1 time "},
        {"INSERT INTO chunk VALUES(9, 0, 1, x'00', 0)", "1 chunk of undeclared streams"},
        {"INSERT INTO event VALUES(1, 'tare', '{}'), (2, 'refused', 'x')", "(1 event)"},
        {"UPDATE meta SET value = value || '\nlimits: {stream_lost_s: 0.6}' WHERE key = 'rig';"
         "DELETE FROM chunk WHERE stream = 1 AND seq >= 6",
         "mocap stream 1: silent for 0."},
        {"DROP TABLE clock", "the database is damaged"},
    };
    struct bench *bench = *state;
    char good[128];
    snprintf(good, sizeof good, "%s/good.wbr", bench->folder);
    small_make(good, true);
    old_recording_make(good);
    for (size_t i = 0; i < sizeof harms / sizeof harms[0]; i++) {
        bench_copy(good, bench->path);
        old_recording_run(bench->path, harms[i].sql);
        struct wb_survey survey;
        look(bench->path, false, &survey);
        expect_only(&survey, harms[i].words);
        unlink(bench->path);
    }
}

/* One of the problems found begins with these words. */
static void expect_among(const struct wb_survey *survey, const char *words)
{
    char text[256], all[2048] = "";
    for (int at = 0; wb_survey_problem(survey, &at, text, sizeof text);) {
        if (strncmp(text, words, strlen(words)) == 0)
            return;
        snprintf(all + strlen(all), sizeof all - strlen(all), "\n%s", text);
    }
    fail_msg("found '%s', expected '%s'", all, words);
}

/* Rows 1 to 3 are the streams, 4 to 8 meta, then the chunks. */
static void each_kind_of_damage_to_a_row_is_found_with_its_position(void **state)
{
    static const struct {
        const char *sql, *words;
    } harms[] = {
        {"UPDATE chunk SET t_ns = t_ns + 1 WHERE n = 15",
         "1 row is damaged (CRC-32): row 15 (stream 0, chunk 6)"},
        {"UPDATE meta SET value = value || ' ' WHERE key = 'rig'",
         "1 row is damaged (CRC-32): row 4 (meta 'rig')"},
        {"UPDATE stream SET settings = 'x' WHERE id = 1",
         "1 row is damaged (CRC-32): row 2 (stream)"},
        {"UPDATE event SET text = 'x' WHERE kind = 'mark'", "1 row is damaged (CRC-32): row 136 "},
        {"UPDATE clock SET rtt_ns = 0", "1 row is damaged (CRC-32): row 137 (clock)"},
        {"UPDATE meta SET value = '0' WHERE key = 'digest'", "it was not closed properly"},
        {"DELETE FROM event WHERE kind = 'mark'", "1 row is missing: row 136"},
        {"DELETE FROM chunk WHERE n BETWEEN 20 AND 24 OR n = 40",
         "6 rows are missing: rows 20 to 24, row 40"},
        {"DELETE FROM meta WHERE key = 'digest'", "it was not closed properly"},
        {"UPDATE chunk SET n = 1000 WHERE n = 50; UPDATE chunk SET n = 50 WHERE n = 51;"
         "UPDATE chunk SET n = 51 WHERE n = 1000",
         "2 rows are damaged (CRC-32): row 50 (stream 0, chunk 42)"},
        {"UPDATE chunk SET chain = chain + 1 WHERE n = 60",
         "2 rows are not in the order of writing: row 60 (stream "},
        {"UPDATE chunk SET crc32 = crc32 + 1 WHERE n = 60", "1 row is damaged (CRC-32): row 60 "},
        {"PRAGMA user_version = 1; UPDATE clock SET rtt_ns = 0", "1 row is damaged"},
        {"DROP TABLE clock", "the database is damaged"},
    };
    struct bench *bench = *state;
    char good[128];
    snprintf(good, sizeof good, "%s/good.wbr", bench->folder);
    small_make(good, true);
    for (size_t i = 0; i < sizeof harms / sizeof harms[0]; i++) {
        bench_copy(good, bench->path);
        old_recording_run(bench->path, harms[i].sql);
        struct wb_survey survey;
        look(bench->path, false, &survey);
        expect_among(&survey, harms[i].words);
        assert_true(survey.check.is_protected);
        unlink(bench->path);
    }
}

static void old_recording_reads_the_same_and_is_partly_protected(void **state)
{
    struct bench *bench = *state;
    struct wb_survey survey, old;
    small_make(bench->path, true);
    look(bench->path, true, &survey);
    old_recording_make(bench->path);
    look(bench->path, true, &old);
    assert_true(wb_survey_is_whole(&old));
    assert_true(survey.check.is_protected);
    assert_false(old.check.is_protected);
    assert_int_equal(old.check.rows, survey.check.rows - 1); /* all but the digest */
    assert_memory_equal(old.streams, survey.streams, sizeof old.streams);
    assert_int_equal(old.events, survey.events);
}

/* The recording computer stalled, and all data arrived later: nothing is lost. Rejected lines
 * before the tare are tolerated. */
static void gap_shared_by_all_streams_is_no_problem(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    old_recording_make(bench->path);
    old_recording_run(bench->path,
                      "UPDATE chunk SET t_ns = t_ns + 5000000000 WHERE t_ns > "
                      "(SELECT (min(t_ns) + max(t_ns)) / 2 FROM chunk);"
                      "INSERT INTO event VALUES(1, 'refused', 'x'), (2, 'tare', '{}')");
    struct wb_survey survey;
    look(bench->path, false, &survey);
    assert_true(survey.streams[1].longest_silence_ns > INT64_C(5000000000));
    assert_true(survey.silence_limit_ns > 0);
    assert_true(wb_survey_is_whole(&survey));
}

/* --- export --- */

static void read_table(const char *folder, const char *name, char **text)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_read(path, text, NULL), WB_OK);
}

static int count_lines(const char *text)
{
    int n = 0;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

static void export_writes_every_sample_with_units_and_says_virtual_rig(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_recording *recording = NULL;
    struct wb_rig rig;
    struct wb_export_counts counts;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(wb_replay_rig(recording, &rig), WB_OK);
    assert_int_equal(wb_export_csv(recording, &rig, "test.wbr", bench->folder, &counts), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(counts.load, SMALL_READINGS);
    assert_int_equal(counts.mocap, SMALL_FRAMES * SMALL_MARKERS);
    static const struct {
        const char *name;
        int rows;
    } tables[] = {{"load.csv", SMALL_READINGS},
                  {"mocap.csv", SMALL_FRAMES * SMALL_MARKERS},
                  {"stage.csv", SMALL_REPORTS},
                  {"events.csv", 2},
                  {"clock.csv", 1}};
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
        char *text = NULL;
        read_table(bench->folder, tables[i].name, &text);
        assert_int_equal(count_lines(text), tables[i].rows + 2);
        assert_int_equal(strncmp(text, "# virtual rig, test.wbr\n", 24), 0);
        free(text);
    }
    char *load = NULL;
    read_table(bench->folder, "load.csv", &load);
    double t_s = 0.0, force = 0.0;
    long long t_ns = 0;
    int index = -1;
    const char *row = strchr(load, '\n') + 1; /* the columns' names */
    for (int i = 0; i < SMALL_READINGS; i++) {
        row = strchr(row, '\n') + 1;
        assert_int_equal(sscanf(row, "%lf,%lld,%d,%lf", &t_s, &t_ns, &index, &force), 4);
        assert_int_equal(index, i);
        assert_close(force, small_reading_g(i) * 1e-3 * 9.80665, 1e-15);
        assert_close(t_s, (double)(t_ns - SMALL_START_NS) * 1e-9, 1e-9);
    }
    free(load);
    char *mocap = NULL;
    read_table(bench->folder, "mocap.csv", &mocap);
    /* The shortest texts that read back as the same floats. */
    assert_non_null(strstr(mocap, ",1000,50,50008,0.014,1.499,-0.8858,0.021,0.000207,18,0,0,0\n"));
    free(mocap);
    char *events = NULL;
    read_table(bench->folder, "events.csv", &events);
    assert_non_null(
        strstr(events, "1.000000000,5001000000000,\"mark\",\"a \"\"quoted\"\", text\""));
    free(events);
    char *clock = NULL;
    read_table(bench->folder, "clock.csv", &clock);
    assert_non_null(strstr(clock, "0.000000000,5000000000000,1,141.75,870000\n"));
    free(clock);
    char *stage = NULL;
    read_table(bench->folder, "stage.csv", &stage);
    assert_non_null(strstr(stage, ",idle,0,0\n"));
    assert_non_null(strstr(stage, ",jog,0.05,0\n"));
    free(stage);
    char command[128];
    snprintf(command, sizeof command, "test $(ls %s | grep -c part) -eq 0", bench->folder);
    assert_int_equal(system(command), 0);
}

static void export_into_a_missing_folder_fails_with_one_message(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_recording *recording = NULL;
    struct wb_rig rig;
    struct wb_export_counts counts;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(wb_replay_rig(recording, &rig), WB_OK);
    assert_int_equal(wb_export_csv(recording, &rig, "x", "/no/such/folder", &counts), WB_ERR_IO);
    assert_int_equal(bench->messages, 1);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(whole_recording_has_no_problem),
        FACT(gap_shared_by_all_streams_is_no_problem),
        FACT(each_kind_of_damage_to_an_old_recording_is_found_and_named),
        FACT(each_kind_of_damage_to_a_row_is_found_with_its_position),
        FACT(old_recording_reads_the_same_and_is_partly_protected),
        FACT(export_writes_every_sample_with_units_and_says_virtual_rig),
        FACT(export_into_a_missing_folder_fails_with_one_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
