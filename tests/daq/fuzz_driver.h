/* Common part of the fuzz targets of drivers: feeds a driver in reads of some size, checks that its
 * remarks are printable, and counts and hashes its samples. */
#ifndef WB_TESTS_DAQ_FUZZ_DRIVER_H
#define WB_TESTS_DAQ_FUZZ_DRIVER_H

#include "daq/protocol/drivers.h"
#include "tests/fuzz.h"

struct fuzz_total {
    uint64_t n, hash;
};

/* Counts a sample of this number and these marks. */
static inline void fuzz_count(struct fuzz_total *total, double number, uint64_t marks)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    total->hash = (total->hash ^ bits ^ marks) * UINT64_C(1099511628211) + 1;
    total->n++;
}

static inline void fuzz_remark(void *context, enum wb_log_level level, int64_t t_ns,
                               const char *kind, const char *text)
{
    (void)context;
    (void)level;
    (void)t_ns;
    FUZZ_REQUIRE(kind[0] && text[0]);
    for (const char *c = text; *c; c++)
        FUZZ_REQUIRE(*c >= 0x20 && *c < 0x7f);
}

/* Feeds a fresh driver in reads of at most `step` bytes. `sink` takes the samples; its context is a
 * struct fuzz_total. */
static inline struct fuzz_total fuzz_feed(const struct wb_driver *driver, const struct wb_rig *rig,
                                          struct wb_sink sink, const uint8_t *bytes, size_t n,
                                          size_t step)
{
    struct fuzz_total total = {0};
    sink.context = &total;
    sink.remark = fuzz_remark;
    void *const state = calloc(1, driver->state_size);
    FUZZ_REQUIRE(state && driver->init(state, rig) == WB_OK);
    for (size_t at = 0; at < n; at += step)
        driver->receive(state, 7, bytes + at, n - at < step ? n - at : step, &sink);
    free(state);
    return total;
}

/* The result must not depend on the division into reads. */
static inline void fuzz_cuts(const struct wb_driver *driver, const struct wb_rig *rig,
                             struct wb_sink sink, const uint8_t *bytes, size_t n)
{
    const struct fuzz_total whole = fuzz_feed(driver, rig, sink, bytes, n, n ? n : 1);
    const struct fuzz_total cut = fuzz_feed(driver, rig, sink, bytes, n, 3);
    FUZZ_REQUIRE(whole.n == cut.n && whole.hash == cut.hash);
}

#ifndef WB_LIBFUZZER

/* The same as fuzz_main() with seeds of text, 32 at most. */
static inline int fuzz_main_text(int argc, char **argv, const char *const *seeds, size_t n_seeds,
                                 unsigned long n_runs)
{
    size_t sizes[32];
    const uint8_t *pointers[32];
    FUZZ_REQUIRE(n_seeds <= 32);
    for (size_t i = 0; i < n_seeds; i++) {
        pointers[i] = (const uint8_t *)seeds[i];
        sizes[i] = strlen(seeds[i]);
    }
    return fuzz_main(argc, argv, pointers, sizes, n_seeds, n_runs);
}

#endif

#endif
