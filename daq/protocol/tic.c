#include "daq/protocol/tic.h"

#include <math.h>
#include <string.h>

/* Offsets and lengths (bytes) of variables (guide, section 7) and settings (section 6). */
#define VARIABLE_STATUS 0x00   /* operation, flags, errors: 4 bytes */
#define VARIABLE_PLANNING 0x09 /* mode, target position: 5 */
#define VARIABLE_POSITION 0x22 /* position, velocity: 8 */
#define VARIABLE_UP_TIME 0x35  /* 4 */
#define SETTING_CONTROL_MODE 0x01
#define SETTING_COMMAND_TIMEOUT 0x09
#define SETTING_PINS 0x3B  /* five pins, current limit, step mode: 7 */
#define SETTING_SPEED 0x47 /* speed, deceleration, acceleration, soft error response: 13 */

#define PIN_FUNCTION 0x0F
#define PIN_LIMIT_FORWARD 8
#define PIN_LIMIT_REVERSE 9

static size_t put_request(uint8_t *bytes, uint8_t command, uint8_t offset, uint8_t length)
{
    bytes[0] = command;
    bytes[1] = offset;
    bytes[2] = length;
    return 3;
}

size_t wb_tic_ask_status(uint8_t bytes[WB_TIC_ASK_BYTES])
{
    size_t n = put_request(bytes, WB_TIC_GET_VARIABLE, VARIABLE_STATUS, 4);
    n += put_request(bytes + n, WB_TIC_GET_VARIABLE, VARIABLE_PLANNING, 5);
    n += put_request(bytes + n, WB_TIC_GET_VARIABLE, VARIABLE_POSITION, 8);
    return n + put_request(bytes + n, WB_TIC_GET_VARIABLE, VARIABLE_UP_TIME, 4);
}

size_t wb_tic_ask_settings(uint8_t bytes[WB_TIC_ASK_BYTES])
{
    size_t n = put_request(bytes, WB_TIC_GET_SETTING, SETTING_CONTROL_MODE, 1);
    n += put_request(bytes + n, WB_TIC_GET_SETTING, SETTING_COMMAND_TIMEOUT, 2);
    n += put_request(bytes + n, WB_TIC_GET_SETTING, SETTING_PINS, 7);
    return n + put_request(bytes + n, WB_TIC_GET_SETTING, SETTING_SPEED, 13);
}

static uint16_t read_16(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static uint32_t read_32(const uint8_t *bytes)
{
    return (uint32_t)read_16(bytes) | (uint32_t)read_16(bytes + 2) << 16;
}

static int32_t read_signed(const uint8_t *bytes)
{
    return (int32_t)read_32(bytes);
}

bool wb_tic_decode_status(const uint8_t bytes[WB_TIC_STATUS_BYTES], struct wb_tic_status *status)
{
    *status = (struct wb_tic_status){.operation = bytes[0],
                                     .flags = bytes[1],
                                     .errors = read_16(bytes + 2),
                                     .planning = bytes[4],
                                     .target = read_signed(bytes + 5),
                                     .position = read_signed(bytes + 9),
                                     .velocity = read_signed(bytes + 13),
                                     .up_time_ms = read_32(bytes + 17)};
    return status->operation <= WB_TIC_NORMAL && status->operation % 2 == 0 &&
           status->errors < 2 * WB_TIC_ERROR_ERR_LINE &&
           status->planning <= WB_TIC_TARGET_VELOCITY &&
           (status->velocity == 0 || status->operation != WB_TIC_RESET);
}

bool wb_tic_decode_settings(const uint8_t bytes[WB_TIC_SETTINGS_BYTES],
                            struct wb_tic_settings *settings)
{
    *settings = (struct wb_tic_settings){.control_mode = bytes[0],
                                         .command_timeout_ms = read_16(bytes + 1),
                                         .current_limit = bytes[8],
                                         .step_mode = bytes[9],
                                         .max_speed = read_32(bytes + 10),
                                         .max_deceleration = read_32(bytes + 14),
                                         .max_acceleration = read_32(bytes + 18),
                                         .soft_error_response = bytes[22]};
    memcpy(settings->pins, bytes + 3, sizeof settings->pins);
    return settings->control_mode <= 7 && settings->command_timeout_ms <= 60000 &&
           settings->max_speed <= WB_TIC_MOST_SPEED && settings->max_acceleration > 0 &&
           settings->max_acceleration <= INT32_MAX && settings->max_deceleration <= INT32_MAX &&
           settings->soft_error_response < WB_TIC_RESPONSES;
}

bool wb_tic_has_limit_switch(const struct wb_tic_settings *settings, bool forward)
{
    const int wanted = forward ? PIN_LIMIT_FORWARD : PIN_LIMIT_REVERSE;
    for (size_t i = 0; i < sizeof settings->pins; i++)
        if ((settings->pins[i] & PIN_FUNCTION) == wanted)
            return true;
    return false;
}

double wb_tic_acceleration(const struct wb_tic_settings *settings, double steps)
{
    const double up = settings->max_acceleration;
    const double down = settings->max_deceleration > 0 ? settings->max_deceleration : up;
    return fmin(up, down) * WB_TIC_ACCELERATION_UNIT / steps;
}

void wb_tic_encode_long(uint8_t bytes[WB_TIC_LONG_BYTES], uint8_t command, int32_t value)
{
    const uint32_t raw = (uint32_t)value;
    bytes[0] = command;
    bytes[1] = 0;
    for (int i = 0; i < 4; i++) {
        const uint8_t part = (uint8_t)(raw >> 8 * i);
        bytes[1] |= (uint8_t)((part >> 7) << i);
        bytes[2 + i] = part & 0x7F;
    }
}

int32_t wb_tic_decode_long(const uint8_t data[WB_TIC_LONG_BYTES - 1])
{
    uint8_t parts[4];
    for (int i = 0; i < 4; i++)
        parts[i] = (uint8_t)(data[1 + i] | (data[0] >> i & 1) << 7);
    return read_signed(parts);
}

int wb_tic_data_bytes(uint8_t command)
{
    switch (command) {
    case WB_TIC_EXIT_SAFE_START:
    case WB_TIC_ENERGIZE:
    case WB_TIC_DEENERGIZE:
    case WB_TIC_HALT_AND_HOLD:
    case WB_TIC_CLEAR_DRIVER_ERROR:
    case WB_TIC_RESET_COMMAND_TIMEOUT:
        return 0;
    case WB_TIC_GO_HOME:
        return 1;
    case WB_TIC_GET_VARIABLE:
    case WB_TIC_GET_SETTING:
        return 2;
    case WB_TIC_SET_TARGET_POSITION:
    case WB_TIC_SET_TARGET_VELOCITY:
    case WB_TIC_SET_MAX_SPEED:
        return WB_TIC_LONG_BYTES - 1;
    default:
        return -1;
    }
}

int wb_tic_alarm(uint16_t errors)
{
    for (int bit = 0; bit < 16; bit++)
        if ((errors & ~WB_TIC_ERRORS_OF_REST) >> bit & 1)
            return WB_TIC_ALARM + bit;
    return 0;
}

const char *wb_tic_alarm_text(int alarm)
{
    static const char *const texts[16] = {
        [1] = "motor driver error: the driver is too hot or the motor is short-circuited",
        [2] = "low VIN: the motor supply is off or its voltage too low",
        [3] = "the kill switch is active",
        [4] = "a required input is invalid: set the control mode to Serial / I2C / USB",
        [5] = "serial error: the Tic received damaged bytes",
        [8] = "its ERR line is held high by another device",
    };
    const int bit = alarm - WB_TIC_ALARM;
    return bit >= 0 && bit < 16 && texts[bit] ? texts[bit] : "unknown error";
}
