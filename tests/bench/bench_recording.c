/* Rate at which chunks are recorded without a drop. Baseline in the same run: write(2) of the same
 * bytes with a 24-byte header each, and fdatasync() every 100 ms. Then the speed of reading the
 * recording with every CRC checked, compared with read(2) and crc32() of the baseline's file. Last,
 * the time for which a push blocks the poll loop at a hundred times the data rate of a bench. */
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#include "daq/recording/writer_private.h"

#define N_CHUNKS 300000
#define BENCH_RATE 220.0 /* chunks/s of a bench: 80 readings, 120 frames, 20 reports */
#define GOAL (100.0 * BENCH_RATE)
#define PACED_SECONDS 3.0

static char folder[256];

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void stop(const char *what)
{
    fprintf(stderr, "bench_recording: %s failed\n", what);
    exit(1);
}

/* A bench's mix: frames of 7 markers, short lines of the load cell, reports of the stage. */
static size_t chunk_of(int64_t i, int *stream, uint8_t bytes[512])
{
    static const size_t sizes[11] = {480, 12, 480, 12, 480, 12, 480, 12, 480, 480, 48};
    static const int streams[11] = {1, 0, 1, 0, 1, 0, 1, 0, 1, 1, 2};
    size_t n = sizes[i % 11];
    *stream = streams[i % 11];
    for (size_t k = 0; k < n; k += 8) {
        uint64_t word = (uint64_t)i * UINT64_C(0x9e3779b97f4a7c15) + k;
        memcpy(bytes + k, &word, n - k < 8 ? n - k : 8);
    }
    return n;
}

static struct wb_writer *start(const char *path, size_t capacity)
{
    struct wb_recording *recording;
    struct wb_writer *writer;
    struct wb_writer_settings settings;
    int id;
    wb_writer_default_settings(&settings);
    if (capacity) {
        settings.capacity_bytes = capacity;
        settings.capacity_entries = N_CHUNKS + 1;
    }
    if (wb_recording_create(&recording, path) != WB_OK)
        stop("creating");
    for (int i = 0; i < 3; i++) {
        if (wb_recording_add_stream(recording, (enum wb_role)i, "memory:", "x", "", &id) != WB_OK)
            stop("declaring streams");
    }
    if (wb_writer_start(&writer, recording, &settings) != WB_OK)
        stop("starting the writer");
    return writer;
}

/* Chunks/s from the first push to the closed file. The queue takes all of them. */
static double record(const char *path, uint64_t *bytes_total)
{
    double began = now_s();
    struct wb_writer *writer = start(path, (size_t)512 << 20);
    uint8_t bytes[512];
    for (int64_t i = 0; i < N_CHUNKS; i++) {
        int stream;
        size_t n = chunk_of(i, &stream, bytes);
        *bytes_total += n;
        if (!wb_writer_push_chunk(writer, stream, i * 1000, bytes, n))
            stop("recording without a drop");
    }
    if (wb_writer_finish(writer) != WB_OK)
        stop("finishing");
    return N_CHUNKS / (now_s() - began);
}

static double write_raw(const char *path)
{
    double began = now_s(), synced = began;
    int descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    uint8_t record[24 + 512];
    for (int64_t i = 0; i < N_CHUNKS; i++) {
        int stream;
        size_t n = chunk_of(i, &stream, record + 24);
        int64_t t_ns = i * 1000;
        memset(record, 0, 24);
        memcpy(record, &t_ns, 8);
        memcpy(record + 8, &stream, 4);
        memcpy(record + 16, &n, 8);
        if (write(descriptor, record, 24 + n) != (ssize_t)(24 + n))
            stop("writing");
        if (now_s() - synced > 0.1) {
            if (fdatasync(descriptor) != 0)
                stop("fdatasync");
            synced = now_s();
        }
    }
    if (fdatasync(descriptor) != 0)
        stop("fdatasync");
    close(descriptor);
    return N_CHUNKS / (now_s() - began);
}

static enum wb_status count_chunk(void *context, const struct wb_chunk *chunk)
{
    uint64_t *count = context;
    *count += chunk->intact;
    return WB_OK;
}

static double walk(const char *path)
{
    double began = now_s();
    struct wb_recording *recording;
    uint64_t intact = 0;
    if (wb_recording_open(&recording, path) != WB_OK ||
        wb_recording_each_chunk(recording, count_chunk, &intact) != WB_OK ||
        wb_recording_close(recording) != WB_OK || intact != N_CHUNKS)
        stop("walking");
    return N_CHUNKS / (now_s() - began);
}

static double read_raw(const char *path)
{
    double began = now_s();
    static uint8_t block[1 << 16];
    int descriptor = open(path, O_RDONLY);
    uLong crc = crc32(0, NULL, 0);
    ssize_t n;
    while ((n = read(descriptor, block, sizeof block)) > 0)
        crc = crc32(crc, block, (uInt)n);
    close(descriptor);
    if (crc == 0)
        stop("reading");
    return N_CHUNKS / (now_s() - began);
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A hundred times the bench's rate with the default queue: drops, and what a push costs the loop.
 */
static void record_paced(const char *path)
{
    struct wb_writer *writer = start(path, 0);
    const int64_t n_chunks = (int64_t)(PACED_SECONDS * GOAL);
    double *took = malloc((size_t)n_chunks * sizeof *took);
    if (!took)
        stop("allocating");
    uint8_t bytes[512];
    double began = now_s();
    for (int64_t i = 0; i < n_chunks; i++) {
        int stream;
        size_t n = chunk_of(i, &stream, bytes);
        while (now_s() - began < (double)i / GOAL)
            usleep(1000);
        double before = now_s();
        wb_writer_push_chunk(writer, stream, i * 1000, bytes, n);
        took[i] = now_s() - before;
    }
    uint64_t drops = wb_writer_drops(writer, -1);
    struct wb_writer_counts counts;
    wb_writer_counts(writer, &counts);
    if (wb_writer_finish(writer) != WB_OK)
        stop("finishing");
    qsort(took, (size_t)n_chunks, sizeof *took, compare);
    printf("paced at %.0f chunks/s for %g s: %" PRIu64 " drops; a push takes %.2g us (median), "
           "%.2g us (99.9 %%), %.2g us (longest); at most %.0f kB waited\n",
           GOAL, PACED_SECONDS, drops, took[n_chunks / 2] * 1e6, took[n_chunks / 1000 * 999] * 1e6,
           took[n_chunks - 1] * 1e6, (double)counts.most_waiting_bytes * 1e-3);
    free(took);
}

int main(void)
{
    char recording[300], raw[300], paced[300];
    const char *tmp = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%.200s/wb-bench-XXXXXX", tmp && tmp[0] ? tmp : "/tmp");
    if (!mkdtemp(folder))
        stop("making a folder");
    snprintf(recording, sizeof recording, "%s/bench.wbr", folder);
    snprintf(raw, sizeof raw, "%s/bench.raw", folder);
    snprintf(paced, sizeof paced, "%s/paced.wbr", folder);
    uint64_t bytes = 0;
    double recorded = record(recording, &bytes);
    double written = write_raw(raw);
    double megabytes = (double)bytes / N_CHUNKS * 1e-6;
    printf("recorded without a drop: %.3g chunks/s (%.1f MB/s); goal %.3g\n", recorded,
           recorded * megabytes, GOAL);
    printf("  baseline write(2) with fdatasync every 100 ms: %.3g chunks/s; ratio %.2f\n", written,
           recorded / written);
    double walked = walk(recording), scanned = read_raw(raw);
    printf("walked with every CRC checked: %.3g chunks/s (%.1f MB/s)\n", walked,
           walked * megabytes);
    printf("  baseline read(2) and crc32() of the raw file: %.3g chunks/s; ratio %.2f\n", scanned,
           walked / scanned);
    record_paced(paced);
    unlink(recording);
    unlink(raw);
    unlink(paced);
    rmdir(folder);
    return 0;
}
