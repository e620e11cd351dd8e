/* Common part of the fuzz targets of harnesses: a folder with the file `h.yaml` and the wire or
 * properties file `w.yaml` that it names, and messages that are kept. */
#ifndef WB_TESTS_ANALYSIS_HARNESS_FUZZ_HARNESS_H
#define WB_TESTS_ANALYSIS_HARNESS_FUZZ_HARNESS_H

#include <math.h>

#include "analysis/harness/harness_session.h"
#include "tests/fuzz.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

/* Few fibres, for speed. */
static const struct wb_harness_settings fuzz_coarse = {.torsion = 1.0,
                                                       .fibres = {.n_rings = 2, .n_around = 8}};

static char fuzz_harness_path[64], fuzz_wire_path[64];

static inline void fuzz_remove_folder(void)
{
    (void)remove_folder(NULL);
}

/* At the first call. */
static inline void fuzz_begin(void)
{
    if (fuzz_harness_path[0])
        return;
    FUZZ_REQUIRE(make_folder(NULL) == 0);
    FUZZ_REQUIRE(atexit(fuzz_remove_folder) == 0);
    snprintf(fuzz_harness_path, sizeof fuzz_harness_path, "%s/h.yaml", folder);
    snprintf(fuzz_wire_path, sizeof fuzz_wire_path, "%s/w.yaml", folder);
}

static inline void fuzz_write(const char *path, const void *bytes, size_t n)
{
    FILE *const file = fopen(path, "wb");
    FUZZ_REQUIRE(file != NULL);
    FUZZ_REQUIRE(fwrite(bytes, 1, n, file) == n && fclose(file) == 0);
}

static inline bool fuzz_is_finite(const double *numbers, int n)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(numbers[i]))
            return false;
    }
    return true;
}

/* A state that is shown: positions and forces are numbers. */
static inline void fuzz_check_state(const struct wb_harness_session *session)
{
    const struct wb_harness_plan *const plan = wb_harness_session_plan(session);
    const struct wb_harness_step_result *const result = &wb_harness_session_state(session)->result;
    for (int i = 0; i < wb_harness_session_n_places(session); i++) {
        FUZZ_REQUIRE(fuzz_is_finite(result->places[i].position, 3));
        FUZZ_REQUIRE(fuzz_is_finite(&result->places[i].curvature, 1));
    }
    for (int i = 0; i < plan->n_items; i++)
        FUZZ_REQUIRE(!result->forces[i].is_mounted || fuzz_is_finite(&result->forces[i].size, 1));
    FUZZ_REQUIRE(result->fraction >= 0.0 && result->fraction <= 1.0);
    FUZZ_REQUIRE(result->n_snaps >= 0 && result->n_snaps <= WB_HARNESS_MOST_SNAPS);
}

/* Stops a step after some increments, so that every input takes a short time. */
struct fuzz_patience {
    int increments;
};

static inline bool fuzz_watch(void *context, double fraction)
{
    struct fuzz_patience *const patience = context;
    FUZZ_REQUIRE(isfinite(fraction));
    return patience->increments-- > 0;
}

#endif
