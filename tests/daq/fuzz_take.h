/* Common part of the fuzz targets of readers of takes: any bytes are a consistent take, or rejected
 * with a reason. */
#ifndef WB_TESTS_DAQ_FUZZ_TAKE_H
#define WB_TESTS_DAQ_FUZZ_TAKE_H

#include <math.h>

#include "daq/take/take_reader.h"
#include "tests/daq/take_example.h"
#include "tests/daq/take_missing.h"
#include "tests/fuzz.h"

static inline void fuzz_check_take(const struct wb_take *take)
{
    static struct wb_mocap_frame frame;
    FUZZ_REQUIRE(take->n_frames > 0);
    for (size_t i = 0; i < take->n_frames; i++) {
        FUZZ_REQUIRE(isfinite(take->frames[i].t));
        FUZZ_REQUIRE(take->frames[i].first <= take->frames[i + 1].first);
        FUZZ_REQUIRE(i == 0 || take->frames[i].number > take->frames[i - 1].number);
        (void)wb_take_frame_at(take, i, &frame);
    }
    FUZZ_REQUIRE(take->frames[take->n_frames].first == take->n_places);
    for (size_t i = 0; i < take->n_places; i++) {
        FUZZ_REQUIRE(take->places[i].point < take->n_points);
        for (int k = 0; k < 3; k++)
            FUZZ_REQUIRE(fabsf(take->places[i].position[k]) <= 1.01e4F);
    }
    FUZZ_REQUIRE(take_missing(take) <= 1.0);
}

static inline int fuzz_take(const struct wb_take_reader *reader, const uint8_t *bytes, size_t n)
{
    struct wb_take take;
    struct wb_reason why = {.text = ""};
    (void)reader->is(bytes, n);
    if (reader->read(&take, "a", bytes, n, &why) == WB_OK) {
        fuzz_check_take(&take);
    } else {
        FUZZ_REQUIRE(why.text[0] != '\0');
        FUZZ_REQUIRE(take.frames == NULL && take.places == NULL && take.points == NULL);
    }
    wb_take_release(&take);
    return 0;
}

#endif
