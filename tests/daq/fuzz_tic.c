/* Any bytes from a Tic are replies or dropped, independent of the division into reads. */
#include "tests/daq/fuzz_driver.h"

#include <math.h>

#include "tests/daq/tic_example.h"

static void take_stage(void *context, const struct wb_stage_report *report)
{
    FUZZ_REQUIRE(isfinite(report->position));
    FUZZ_REQUIRE((report->state == WB_STAGE_ALARM) == (report->alarm != 0));
    fuzz_count(context, report->position, (uint64_t)report->state << 8 | (uint64_t)report->alarm);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    const struct wb_rig rig = {
        .gravity = 9.81, .time_scale = 1.0, .stage = {.down = -1, .steps = 800e3, .speed = 1e-3}};
    fuzz_cuts(&wb_stage_tic, &rig, (struct wb_sink){.stage = take_stage}, bytes, n);
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const struct wb_tic_status status[] = {
        {.operation = 10, .planning = 1, .target = -100000, .position = 1234, .velocity = -5},
        {.operation = 4, .flags = 0x1F, .errors = 0x1FE, .up_time_ms = 1u << 31},
        {.operation = 4, .errors = 0xC0, .position = INT32_MIN, .up_time_ms = 7},
    };
    uint8_t bytes[WB_TIC_SETTINGS_BYTES + 3 * WB_TIC_STATUS_BYTES];
    tic_example_settings(bytes, &tic_example_usual);
    for (size_t i = 0; i < 3; i++)
        tic_example_status(bytes + WB_TIC_SETTINGS_BYTES + i * WB_TIC_STATUS_BYTES, &status[i]);
    const uint8_t *const seeds[] = {bytes, bytes};
    const size_t sizes[] = {sizeof bytes, WB_TIC_SETTINGS_BYTES};
    return fuzz_main(argc, argv, seeds, sizes, 2, 100000);
}

#endif
