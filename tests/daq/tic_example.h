/* Replies of a Tic, byte by byte according to its guide, for the tests of its driver. */
#ifndef WB_TESTS_DAQ_TIC_EXAMPLE_H
#define WB_TESTS_DAQ_TIC_EXAMPLE_H

#include <string.h>

#include "daq/protocol/tic.h"

/* Factory settings, except a limit switch and the speed. */
static const struct wb_tic_settings tic_example_usual = {
    .command_timeout_ms = 1000,
    .pins = {0, 0, 0, 0, 9},
    .current_limit = 6,
    .max_speed = 100000000,
    .max_acceleration = 4000000,
    .soft_error_response = WB_TIC_BRAKE,
};

static inline void tic_example_put(uint8_t *bytes, uint32_t value, int n)
{
    for (int i = 0; i < n; i++)
        bytes[i] = (uint8_t)(value >> 8 * i);
}

static inline void tic_example_settings(uint8_t bytes[WB_TIC_SETTINGS_BYTES],
                                        const struct wb_tic_settings *settings)
{
    bytes[0] = settings->control_mode;
    tic_example_put(bytes + 1, settings->command_timeout_ms, 2);
    memcpy(bytes + 3, settings->pins, 5);
    bytes[8] = settings->current_limit;
    bytes[9] = settings->step_mode;
    tic_example_put(bytes + 10, settings->max_speed, 4);
    tic_example_put(bytes + 14, settings->max_deceleration, 4);
    tic_example_put(bytes + 18, settings->max_acceleration, 4);
    bytes[22] = settings->soft_error_response;
}

static inline void tic_example_status(uint8_t bytes[WB_TIC_STATUS_BYTES],
                                      const struct wb_tic_status *status)
{
    bytes[0] = status->operation;
    bytes[1] = status->flags;
    tic_example_put(bytes + 2, status->errors, 2);
    bytes[4] = status->planning;
    tic_example_put(bytes + 5, (uint32_t)status->target, 4);
    tic_example_put(bytes + 9, (uint32_t)status->position, 4);
    tic_example_put(bytes + 13, (uint32_t)status->velocity, 4);
    tic_example_put(bytes + 17, status->up_time_ms, 4);
}

#endif
