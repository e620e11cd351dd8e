/* Pololu Tic, a stepper controller, on its serial port: commands and replies as pure functions of
 * bytes, for the driver and the virtual rig. Source: Pololu, Tic user's guide (0J71), sections 6 to
 * 9; compact protocol, CRC off.
 *
 * A command is a byte from 0x80 on, its data bytes are below 0x80. Only requests are answered, with
 * the requested bytes without a frame. Two groups of requests are used, for settings and status,
 * whose replies differ in length.
 *
 * Positions are in microsteps, speeds in microsteps per 10 000 s, accelerations in microsteps/s per
 * 100 s. */
#ifndef WB_DAQ_PROTOCOL_TIC_H
#define WB_DAQ_PROTOCOL_TIC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WB_TIC_SPEED_UNIT 1e-4        /* microsteps/s */
#define WB_TIC_ACCELERATION_UNIT 1e-2 /* microsteps/s2 */
#define WB_TIC_MOST_SPEED 500000000   /* 50 000 microsteps/s */
#define WB_TIC_EXIT_SAFE_START_MS 200 /* time for the Tic to start after Exit safe start */

enum {
    WB_TIC_EXIT_SAFE_START = 0x83,
    WB_TIC_ENERGIZE = 0x85,
    WB_TIC_DEENERGIZE = 0x86,
    WB_TIC_HALT_AND_HOLD = 0x89, /* without deceleration: makes the position uncertain */
    WB_TIC_CLEAR_DRIVER_ERROR = 0x8A,
    WB_TIC_RESET_COMMAND_TIMEOUT = 0x8C,
    WB_TIC_GO_HOME = 0x97, /* 7 bits: 0 in reverse, 1 forward */
    WB_TIC_GET_VARIABLE = 0xA1,
    WB_TIC_GET_SETTING = 0xA8,
    WB_TIC_SET_TARGET_POSITION = 0xE0, /* 32 bits, and those below */
    WB_TIC_SET_TARGET_VELOCITY = 0xE3,
    WB_TIC_SET_MAX_SPEED = 0xE6
};

enum wb_tic_operation {
    WB_TIC_RESET = 0,
    WB_TIC_DEENERGIZED = 2,
    WB_TIC_SOFT_ERROR = 4,
    WB_TIC_WAITING_FOR_ERR_LINE = 6,
    WB_TIC_STARTING_UP = 8,
    WB_TIC_NORMAL = 10
};

/* Bits of the error status. */
enum {
    WB_TIC_ERROR_DEENERGIZED = 1 << 0,
    WB_TIC_ERROR_MOTOR_DRIVER = 1 << 1,
    WB_TIC_ERROR_LOW_VIN = 1 << 2,
    WB_TIC_ERROR_KILL_SWITCH = 1 << 3,
    WB_TIC_ERROR_INPUT = 1 << 4,
    WB_TIC_ERROR_SERIAL = 1 << 5,
    WB_TIC_ERROR_COMMAND_TIMEOUT = 1 << 6,
    WB_TIC_ERROR_SAFE_START = 1 << 7,
    WB_TIC_ERROR_ERR_LINE = 1 << 8,
    /* Errors that wirebench's commands clear: the Tic stands still and waits. */
    WB_TIC_ERRORS_OF_REST =
        WB_TIC_ERROR_DEENERGIZED | WB_TIC_ERROR_COMMAND_TIMEOUT | WB_TIC_ERROR_SAFE_START
};

/* Bits of the flags. */
enum {
    WB_TIC_ENERGIZED = 1 << 0,
    WB_TIC_POSITION_UNCERTAIN = 1 << 1,
    WB_TIC_FORWARD_LIMIT = 1 << 2,
    WB_TIC_REVERSE_LIMIT = 1 << 3,
    WB_TIC_HOMING = 1 << 4
};

enum {
    WB_TIC_NO_TARGET,
    WB_TIC_TARGET_POSITION,
    WB_TIC_TARGET_VELOCITY
};

/* Soft error response (setting 0x53): action when the command timeout has expired. */
enum wb_tic_response {
    WB_TIC_RESPONSE_DEENERGIZE,
    WB_TIC_HALT,           /* halt and hold */
    WB_TIC_BRAKE,          /* decelerate to hold */
    WB_TIC_GO_TO_POSITION, /* go to the position in its settings */
    WB_TIC_RESPONSES
};

/* Status of the Tic. */
#define WB_TIC_STATUS_BYTES 21
struct wb_tic_status {
    uint8_t operation; /* enum wb_tic_operation */
    uint8_t flags;
    uint16_t errors;
    uint8_t planning; /* WB_TIC_TARGET_... */
    int32_t target;   /* position, if `planning` is a target position */
    int32_t position;
    int32_t velocity;
    uint32_t up_time_ms;
};

/* Settings in its non-volatile memory. */
#define WB_TIC_SETTINGS_BYTES 23
struct wb_tic_settings {
    uint8_t control_mode;        /* 0: serial, I2C, USB */
    uint16_t command_timeout_ms; /* 0: none */
    uint8_t pins[5];             /* SCL, SDA, TX, RX, RC: the function in the low four bits */
    uint8_t current_limit, step_mode;
    uint32_t max_speed, max_deceleration, max_acceleration; /* deceleration 0: as acceleration */
    uint8_t soft_error_response;                            /* enum wb_tic_response */
};

/* Requests for status and settings. Return their length, at most WB_TIC_ASK_BYTES. */
#define WB_TIC_ASK_BYTES 12
size_t wb_tic_ask_status(uint8_t bytes[WB_TIC_ASK_BYTES]);
size_t wb_tic_ask_settings(uint8_t bytes[WB_TIC_ASK_BYTES]);

/* Decode a reply; false if the bytes are invalid. */
bool wb_tic_decode_status(const uint8_t bytes[WB_TIC_STATUS_BYTES], struct wb_tic_status *status);
bool wb_tic_decode_settings(const uint8_t bytes[WB_TIC_SETTINGS_BYTES],
                            struct wb_tic_settings *settings);

/* Whether a pin is the limit switch for this direction of counting. */
bool wb_tic_has_limit_switch(const struct wb_tic_settings *settings, bool forward);

/* m/s2, the smaller of acceleration and deceleration, with `steps` microsteps/m. */
double wb_tic_acceleration(const struct wb_tic_settings *settings, double steps);

/* Encodes a command with 32 bits of data, 6 bytes. */
#define WB_TIC_LONG_BYTES 6
void wb_tic_encode_long(uint8_t bytes[WB_TIC_LONG_BYTES], uint8_t command, int32_t value);
/* Decodes its data, without the command byte. */
int32_t wb_tic_decode_long(const uint8_t data[WB_TIC_LONG_BYTES - 1]);

/* Number of data bytes of a command; -1: unknown command. */
int wb_tic_data_bytes(uint8_t command);

/* Alarm number for stage reports: WB_TIC_ALARM + the lowest bit of an error that wirebench's
 * commands do not clear. 0: no such error. */
#define WB_TIC_ALARM 100
int wb_tic_alarm(uint16_t errors);
/* Meaning of an alarm number; never NULL. */
const char *wb_tic_alarm_text(int alarm);

#endif
