/* What the fuzz targets share. With clang -fsanitize=fuzzer and -DWB_LIBFUZZER a target is
 * libFuzzer's; otherwise it drives itself as a test: each seed as it is, each input that libFuzzer
 * once found (files of the folder in FUZZ_CORPUS), then a fixed number of mutations of the seeds
 * from a fixed random sequence. `fuzz_x N [SEED]` runs N mutations, `fuzz_x seeds FOLDER` writes
 * the seeds as files, for libFuzzer to begin with. */
#ifndef WB_TESTS_FUZZ_H
#define WB_TESTS_FUZZ_H

#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n);

/* A property that every input must keep. Not assert(), which release builds leave out. */
#define FUZZ_REQUIRE(condition)                                                                    \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: broken: %s\n", __FILE__, __LINE__, #condition);                \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

#define FUZZ_MAX 70000

#ifndef WB_LIBFUZZER

#include <sys/resource.h>

#include "tests/trials.h"

/* KiB, largest accepted memory in excess of that for the seeds. A sanitizer retains freed memory.
 */
#define FUZZ_MEMORY 65536

static inline long fuzz_memory(void)
{
    struct rusage usage;
    FUZZ_REQUIRE(getrusage(RUSAGE_SELF, &usage) == 0);
    return usage.ru_maxrss;
}

static uint64_t fuzz_state;

static inline uint64_t fuzz_random(void)
{
    fuzz_state ^= fuzz_state << 13;
    fuzz_state ^= fuzz_state >> 7;
    fuzz_state ^= fuzz_state << 17;
    return fuzz_state;
}

static inline size_t fuzz_below(size_t n)
{
    return n ? (size_t)(fuzz_random() % n) : 0;
}

/* One random change: a bit, a byte, an extreme number, a cut, a repeat, a splice of another
 * seed. */
static inline size_t fuzz_mutate(uint8_t *bytes, size_t n, const uint8_t *other, size_t n_other)
{
    static const uint32_t extremes[] = {0,          1,          0xff,       0x7f,   0x7fffffff,
                                        0x80000000, 0xffffffff, 0x7f800000, 0xffff, 0x10000};
    const size_t at = fuzz_below(n);
    switch (fuzz_below(7)) {
    case 0:
        if (n)
            bytes[at] ^= (uint8_t)(1U << fuzz_below(8));
        return n;
    case 1:
        if (n)
            bytes[at] = (uint8_t)fuzz_random();
        return n;
    case 2: {
        const uint32_t extreme = extremes[fuzz_below(sizeof extremes / sizeof extremes[0])];
        if (n >= at + 4)
            memcpy(bytes + at, &extreme, 4);
        return n;
    }
    case 3:
        return at;
    case 4: {
        const size_t length = fuzz_below(n - at < 64 ? n - at + 1 : 64);
        if (n + length > FUZZ_MAX)
            return n;
        memmove(bytes + at + length, bytes + at, n - at);
        return n + length;
    }
    case 5: {
        const size_t length = fuzz_below(n - at < 64 ? n - at + 1 : 64);
        memmove(bytes + at, bytes + at + length, n - at - length);
        return n - length;
    }
    default: {
        const size_t from = fuzz_below(n_other), length = fuzz_below(n_other - from + 1);
        if (at + length > FUZZ_MAX)
            return n;
        memcpy(bytes + at, other + from, length);
        return at + length > n ? at + length : n;
    }
    }
}

/* A copy of exactly this size, so that a sanitizer sees one byte too many. */
static inline void fuzz_run(const uint8_t *bytes, size_t n)
{
    uint8_t *const copy = malloc(n ? n : 1);
    FUZZ_REQUIRE(copy != NULL);
    memcpy(copy, bytes, n);
    LLVMFuzzerTestOneInput(copy, n);
    free(copy);
}

/* Runs the inputs of the corpus, which must exist if it is named. Returns their number. */
static inline int fuzz_corpus(const char *folder)
{
    static uint8_t bytes[FUZZ_MAX];
    int n_inputs = 0;
    DIR *const entries = opendir(folder);
    FUZZ_REQUIRE(entries != NULL);
    for (const struct dirent *entry; (entry = readdir(entries));) {
        char path[4096];
        if (entry->d_name[0] == '.')
            continue;
        FUZZ_REQUIRE(snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) <
                     (int)sizeof path);
        FILE *const file = fopen(path, "rb");
        FUZZ_REQUIRE(file != NULL);
        const size_t n = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        fuzz_run(bytes, n);
        n_inputs++;
    }
    closedir(entries);
    FUZZ_REQUIRE(n_inputs > 0);
    return n_inputs;
}

static inline int fuzz_write_seeds(const char *folder, const uint8_t *const *seeds,
                                   const size_t *sizes, size_t n_seeds)
{
    for (size_t i = 0; i < n_seeds; i++) {
        char path[4096];
        FUZZ_REQUIRE(snprintf(path, sizeof path, "%s/seed-%02zu", folder, i) < (int)sizeof path);
        FILE *const file = fopen(path, "wb");
        FUZZ_REQUIRE(file != NULL);
        FUZZ_REQUIRE(fwrite(seeds[i], 1, sizes[i], file) == sizes[i] && fclose(file) == 0);
    }
    return 0;
}

/* Runs the seeds and `n_runs` mutations of them (or as many as the arguments say). */
static inline int fuzz_main(int argc, char **argv, const uint8_t *const *seeds, const size_t *sizes,
                            size_t n_seeds, unsigned long n_runs)
{
    static uint8_t bytes[FUZZ_MAX];
    const char *const corpus = getenv("FUZZ_CORPUS");
    if (argc == 3 && strcmp(argv[1], "seeds") == 0)
        return fuzz_write_seeds(argv[2], seeds, sizes, n_seeds);
    if (argc > 1)
        n_runs = strtoul(argv[1], NULL, 10);
    fuzz_state = argc > 2 ? strtoull(argv[2], NULL, 10) | 1 : UINT64_C(0x9e3779b97f4a7c15);
    for (size_t i = 0; i < n_seeds; i++)
        LLVMFuzzerTestOneInput(seeds[i], sizes[i]);
    const long before = fuzz_memory();
    const int n_found = corpus && *corpus ? fuzz_corpus(corpus) : 0;
    for (unsigned long run = 0; run < n_runs; run++) {
        const size_t seed = fuzz_below(n_seeds), other = fuzz_below(n_seeds);
        size_t n = sizes[seed];
        memcpy(bytes, seeds[seed], n);
        for (size_t k = 1 + fuzz_below(4); k > 0; k--)
            n = fuzz_mutate(bytes, n, seeds[other], sizes[other]);
        fuzz_run(bytes, n);
    }
    const long more = fuzz_memory() - before;
#ifndef __SANITIZE_ADDRESS__
    FUZZ_REQUIRE(more < FUZZ_MEMORY);
#endif
    printf("%zu seeds, %d inputs found before, %lu mutations\n", n_seeds, n_found, n_runs);
    count_trials("Packets, lines and files of any bytes into a decoder", n_seeds + n_runs,
                 "inputs: no crash, no property violated, %.1f MiB at most", (double)more / 1024.0);
    return 0;
}

#endif

#endif
