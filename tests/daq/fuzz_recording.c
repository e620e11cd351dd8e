/* Opening, walking, surveying and decoding any file never crashes, hangs or leaks.
 *
 * With clang -fsanitize=fuzzer and -DWB_LIBFUZZER this is a libFuzzer target. As a test it is
 * driven by itself: random damage to a small recording, plain and compressed, from a fixed seed;
 * `fuzz_recording N [SEED]` runs N cases. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "daq/recording/recording_private.h"
#include "daq/recording/recover.h"
#include "daq/recording/survey.h"
#include "tests/compress.h"
#include "tests/daq/small_test.h"
#include "tests/folder.h"
#include "tests/trials.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n);

static void be_silent(void *context, enum wb_log_level level, const char *domain,
                      const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static uint64_t touched;

static enum wb_status touch_chunk(void *context, const struct wb_chunk *chunk)
{
    ++*(uint64_t *)context;
    for (size_t i = 0; i < chunk->n; i++)
        touched += chunk->bytes[i];
    return WB_OK;
}

static enum wb_status touch_event(void *context, const struct wb_event *event)
{
    (void)context;
    touched += strlen(event->kind) + strlen(event->text);
    return WB_OK;
}

static enum wb_status touch_clock(void *context, const struct wb_clock_row *row)
{
    (void)context;
    touched += (uint64_t)row->stream;
    return WB_OK;
}

static enum wb_status touch_meta(void *context, const char *key, const char *value)
{
    (void)context;
    touched += strlen(key) + strlen(value);
    return WB_OK;
}

/* Opens and walks; returns how many chunks were visited. */
static uint64_t visit(const char *path)
{
    struct wb_recording *recording = NULL;
    uint64_t chunks = 0;
    if (wb_recording_open(&recording, path) != WB_OK)
        return 0;
    struct wb_survey survey;
    char text[256];
    enum wb_status ends[] = {
        wb_survey_run(recording, true, &survey), /* decodes too */
        wb_recording_each_chunk(recording, touch_chunk, &chunks),
        wb_recording_each_event(recording, touch_event, NULL),
        wb_recording_each_clock(recording, touch_clock, NULL),
        wb_recording_each_meta(recording, touch_meta, NULL),
        wb_recording_close(recording),
    };
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        touched += (uint64_t)(ends[i] == WB_OK);
    for (int at = 0; wb_survey_problem(&survey, &at, text, sizeof text);)
        touched += strlen(text);
    return chunks;
}

/* A recovered file, if there is one, opens without a message about damage. */
static void recover(const char *path)
{
    char to[96];
    struct wb_recover found;
    struct wb_recording *recording = NULL;
    struct wb_recording_check check;
    struct wb_reason why;
    snprintf(to, sizeof to, "%s.new", path);
    if (wb_recover_run(path, to, &found, &why) != WB_OK)
        return;
    if (wb_recording_open(&recording, to) != WB_OK ||
        wb_recording_check(recording, &check) != WB_OK || !check.digest_fits ||
        wb_recording_close(recording) != WB_OK)
        abort();
    unlink(to);
}

static void write_file(const char *path, const void *bytes, size_t n)
{
    int descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (descriptor < 0 || write(descriptor, bytes, n) != (ssize_t)n)
        abort();
    close(descriptor);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    wb_log_set_sink(be_silent, NULL);
    char folder[32], path[64];
    if (!temporary_folder_make(folder))
        abort();
    snprintf(path, sizeof path, "%s/case.wbr", folder);
    write_file(path, bytes, n);
    visit(path);
    recover(path);
    return temporary_folder_remove(folder) == 0 ? 0 : -1;
}

#ifndef WB_LIBFUZZER

#define SMALL_CHUNKS 126

static uint64_t random_state;

/* xorshift64*: the same on every machine. */
static uint64_t random_below(uint64_t bound)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return (random_state * UINT64_C(2685821657736338717)) % bound;
}

/* A kind of damage caused by disks, transfers or users. */
static size_t damage(uint8_t *bytes, size_t n)
{
    size_t at = random_below(n), length = 1 + random_below(600);
    if (length > n - at)
        length = n - at;
    switch (random_below(7)) {
    case 0:
        bytes[at] ^= (uint8_t)(1u << random_below(8));
        break;
    case 1:
        bytes[random_below(n < 100 ? n : 100)] = (uint8_t)random_below(256);
        break;
    case 2:
        memset(bytes + at, 0, length);
        break;
    case 3:
        for (size_t i = 0; i < length; i++)
            bytes[at + i] = (uint8_t)random_below(256);
        break;
    case 4:
        return at;
    case 5: /* a page over another one: cycles in the tree */
        if (n >= 8192) {
            size_t from = random_below(n / 4096) * 4096, to = random_below(n / 4096) * 4096;
            memmove(bytes + to, bytes + from, 4096);
        }
        break;
    default: /* the start of a page: types, counts and pointers */
        bytes[at / 4096 * 4096 + random_below(32 < n - at / 4096 * 4096 ? 32 : 1)] =
            (uint8_t)random_below(256);
        break;
    }
    return n;
}

int main(int argc, char **argv)
{
    long cases = argc > 1 ? atol(argv[1]) : 600;
    random_state = argc > 2 ? strtoull(argv[2], NULL, 10) | 1 : 88172645463325252u;
    char folder[32], seed[64], packed[64], path[64];
    if (!temporary_folder_make(folder))
        return 1;
    snprintf(seed, sizeof seed, "%s/seed.wbr", folder);
    snprintf(packed, sizeof packed, "%s/seed.wbr.zst", folder);
    snprintf(path, sizeof path, "%s/case.wbr", folder);
    small_make(seed, true);
    char *sources[2] = {NULL, NULL};
    size_t sizes[2] = {0, 0};
    if (compress_recording(seed, packed) != WB_OK ||
        wb_file_read(seed, &sources[0], &sizes[0]) != WB_OK ||
        wb_file_read(packed, &sources[1], &sizes[1]) != WB_OK)
        return 1;
    bool whole = visit(seed) == SMALL_CHUNKS && visit(packed) == SMALL_CHUNKS;
    wb_log_set_sink(be_silent, NULL);
    long opened = 0;
    for (long i = 0; i < cases && whole; i++) {
        int which = i % 4 == 3; /* a quarter compressed */
        uint8_t *bytes = malloc(sizes[which] + 1);
        if (!bytes)
            return 1;
        memcpy(bytes, sources[which], sizes[which]);
        size_t n = sizes[which];
        for (uint64_t times = 1 + random_below(4); times > 0 && n > 0; times--)
            n = damage(bytes, n);
        write_file(path, bytes, n);
        opened += visit(path) > 0;
        recover(path);
        free(bytes);
    }
    wb_log_set_sink(NULL, NULL);
    unlink(seed);
    unlink(packed);
    unlink(path);
    rmdir(folder);
    free(sources[0]);
    free(sources[1]);
    count_trials("Damaged recordings opened, surveyed and recovered", (uint64_t)cases,
                 "files: no crash, no data with a wrong checksum");
    printf("%ld damaged recordings, chunks read from %ld of them\n", cases, opened);
    /* If nothing could be opened, nothing was tested. */
    return whole && opened > cases / 4 ? 0 : 1;
}

#endif
