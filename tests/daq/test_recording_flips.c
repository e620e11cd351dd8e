/* Every bit of a closed recording, flipped alone: either the damage is detected when the file is
 * opened, read or surveyed, or all data read are correct. The same for every truncation of the
 * file.
 *
 * `test_recording_flips [STEP]` tries every STEP-th bit and length; 1 is all of them. */
#include <fcntl.h>

#include "base/file.h"
#include "base/hash.h"
#include "daq/recording/recording_private.h"
#include "daq/recording/survey.h"
#include "tests/compress.h"
#include "tests/daq/recording_fixture.h"
#include "tests/daq/small_test.h"
#include "tests/trials.h"

static size_t step = 97;

/* Hash of the whole contents of a recording. */

static void add_text(struct wb_hash *hash, const char *text)
{
    wb_hash_add(hash, text, strlen(text) + 1);
}

static void add_integer(struct wb_hash *hash, int64_t value)
{
    wb_hash_add(hash, &value, sizeof value);
}

static enum wb_status add_chunk(void *context, const struct wb_chunk *chunk)
{
    add_integer(context, chunk->stream);
    add_integer(context, chunk->seq);
    add_integer(context, chunk->t_ns);
    add_integer(context, (int64_t)chunk->n);
    add_integer(context, chunk->intact);
    wb_hash_add(context, chunk->bytes, chunk->n);
    return WB_OK;
}

static enum wb_status add_event(void *context, const struct wb_event *event)
{
    add_integer(context, event->t_ns);
    add_text(context, event->kind);
    add_text(context, event->text);
    return WB_OK;
}

static enum wb_status add_clock(void *context, const struct wb_clock_row *row)
{
    add_integer(context, row->stream);
    add_integer(context, row->t_host_ns);
    wb_hash_add(context, &row->t_device, sizeof row->t_device);
    add_integer(context, row->rtt_ns);
    return WB_OK;
}

static enum wb_status add_meta(void *context, const char *key, const char *value)
{
    add_text(context, key);
    add_text(context, value);
    return WB_OK;
}

/* Reads everything. False if damage is detected, by a status or by the survey. */
static bool read_all(const char *path, char hex[WB_SHA256_TEXT])
{
    struct wb_recording *recording = NULL;
    struct wb_survey survey;
    if (wb_recording_open(&recording, path) != WB_OK)
        return false;
    struct wb_hash *const hash = wb_hash_create();
    for (int i = 0; i < wb_recording_n_streams(recording); i++) {
        const struct wb_recording_stream *const stream = wb_recording_stream_at(recording, i);
        add_integer(hash, stream->id);
        add_integer(hash, stream->role);
        add_text(hash, stream->address);
        add_text(hash, stream->protocol);
        add_text(hash, wb_recording_stream_settings(recording, i));
    }
    bool good = wb_recording_each_meta(recording, add_meta, hash) == WB_OK;
    good &= wb_recording_each_chunk(recording, add_chunk, hash) == WB_OK;
    good &= wb_recording_each_event(recording, add_event, hash) == WB_OK;
    good &= wb_recording_each_clock(recording, add_clock, hash) == WB_OK;
    good &= wb_survey_run(recording, false, &survey) == WB_OK && wb_survey_is_whole(&survey) &&
            survey.check.is_protected;
    good &= wb_recording_close(recording) == WB_OK;
    wb_hash_so_far(hash, hex);
    wb_hash_destroy(hash);
    return good;
}

/* A whole recording of a few pages, with a chunk that takes more than one. */
static void make(const char *path)
{
    static const char *const protocols[] = {"generic", "natnet", "grbl"};
    struct wb_recording *recording = NULL;
    int id;
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    assert_int_equal(wb_recording_set_meta(recording, "rig", small_rig), WB_OK);
    assert_int_equal(wb_recording_set_meta(recording, "specimen", small_specimen), WB_OK);
    assert_int_equal(wb_recording_set_meta(recording, "g", "9.80665"), WB_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(wb_recording_add_stream(recording, (enum wb_role)i, "memory:",
                                                 protocols[i], i == 0 ? "unit: g" : "", &id),
                         WB_OK);
    for (int64_t seq = 0; seq < 8; seq++) {
        for (int stream = 0; stream < 3; stream++) {
            static uint8_t bytes[5000];
            const size_t n =
                stream == 1 && seq == 5 ? sizeof bytes : bench_bytes(stream, seq, bytes);
            assert_int_equal(wb_recording_append_chunk(recording, stream, seq,
                                                       bench_time(stream, seq), bytes, n),
                             WB_OK);
        }
    }
    assert_int_equal(wb_recording_append_event(recording, 5, "tare", "{\"force_N\": 0.01}"), WB_OK);
    assert_int_equal(wb_recording_append_event(recording, 6, "mark", "key m"), WB_OK);
    assert_int_equal(wb_recording_append_clock(recording, 1, 7, 12.5, 870000), WB_OK);
    assert_int_equal(wb_recording_append_clock(recording, 1, 8, (double)NAN, 870000), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void write_byte(int descriptor, size_t at, uint8_t byte)
{
    assert_int_equal(pwrite(descriptor, &byte, 1, (off_t)at), 1);
}

/* Flips the bits of the file one after the other. *n_tried bits were tried, *n_noticed noticed. */
static void flip_all(const char *path, const char *expected, size_t *n_tried, size_t *n_noticed)
{
    char *bytes = NULL, hex[WB_SHA256_TEXT];
    size_t size;
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    const int descriptor = open(path, O_WRONLY);
    assert_true(descriptor >= 0);
    for (size_t bit = 0; bit < 8 * size; bit += step) {
        const uint8_t byte = (uint8_t)bytes[bit / 8];
        write_byte(descriptor, bit / 8, (uint8_t)(byte ^ 1 << bit % 8));
        ++*n_tried;
        if (!read_all(path, hex))
            ++*n_noticed;
        else if (strcmp(hex, expected) != 0)
            fail_msg("bit %zu of byte %zu changes what is read, and nobody notices", bit % 8,
                     bit / 8);
        write_byte(descriptor, bit / 8, byte);
    }
    close(descriptor);
    free(bytes);
}

static void every_bit_is_noticed_or_without_effect(void **state)
{
    struct bench *bench = *state;
    char expected[WB_SHA256_TEXT];
    size_t n_tried = 0, n_noticed = 0;
    make(bench->path);
    assert_true(read_all(bench->path, expected));
    flip_all(bench->path, expected, &n_tried, &n_noticed);
    count_trials("Every bit of a recording flipped", n_tried,
                 "bits: %zu detected, %zu without effect on the data", n_noticed,
                 n_tried - n_noticed);
    /* A third of the file holds rows. */
    assert_true(n_noticed > n_tried / 4);
}

static void every_bit_of_a_compressed_one_is_noticed_or_without_effect(void **state)
{
    struct bench *bench = *state;
    char expected[WB_SHA256_TEXT], packed[128];
    size_t n_tried = 0, n_noticed = 0;
    make(bench->path);
    assert_true(read_all(bench->path, expected));
    snprintf(packed, sizeof packed, "%s/test.wbr.zst", bench->folder);
    assert_int_equal(compress_recording(bench->path, packed), WB_OK);
    flip_all(packed, expected, &n_tried, &n_noticed);
    count_trials("Every bit of a compressed recording flipped", n_tried,
                 "bits: %zu detected, %zu without effect on the data", n_noticed,
                 n_tried - n_noticed);
    assert_true(n_noticed > n_tried / 2);
}

static void every_truncation_is_noticed(void **state)
{
    struct bench *bench = *state;
    char *bytes = NULL, hex[WB_SHA256_TEXT];
    size_t size, n_tried = 0;
    make(bench->path);
    assert_int_equal(wb_file_read(bench->path, &bytes, &size), WB_OK);
    for (size_t n = size - 1; n < size; n -= step) {
        assert_int_equal(truncate(bench->path, (off_t)n), 0);
        n_tried++;
        if (read_all(bench->path, hex))
            fail_msg("cut to %zu of %zu bytes, and nobody notices", n, size);
    }
    count_trials("A recording truncated to every length", n_tried, "lengths: all detected");
    free(bytes);
}

int main(int argc, char **argv)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(every_bit_is_noticed_or_without_effect),
        FACT(every_bit_of_a_compressed_one_is_noticed_or_without_effect),
        FACT(every_truncation_is_noticed),
    };
    if (argc > 1)
        step = strtoull(argv[1], NULL, 10);
    return step > 0 ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
}
