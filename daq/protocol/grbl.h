/* GRBL 1.1, the firmware of stepper stages: decoding of its lines, and formatting for the driver
 * and the virtual rig. Pure functions of text.
 *
 * GRBL replies to each line with `ok` or `error:N`, in order. In between it sends status reports
 * (the reply to the real-time byte `?`), `ALARM:N`, messages and its banner.
 */
#ifndef WB_DAQ_PROTOCOL_GRBL_H
#define WB_DAQ_PROTOCOL_GRBL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/sample.h"

/* Real-time bytes: executed at once, without a reply of `ok`. */
enum {
    WB_GRBL_STATUS = '?',
    WB_GRBL_HOLD = '!',
    WB_GRBL_RESUME = '~',
    WB_GRBL_SOFT_RESET = 0x18,
    WB_GRBL_JOG_CANCEL = 0x85
};

/* Numbers of `$` settings. The last four are those of the first axis; the other axes follow. */
enum {
    WB_GRBL_IDLE_DELAY = 1,  /* ms until the motors are switched off after a motion */
    WB_GRBL_ALWAYS_ON = 255, /* value of this setting: never switched off */
    WB_GRBL_INCHES = 13,
    WB_GRBL_SOFT_LIMITS = 20,
    WB_GRBL_STEPS = 100,        /* per mm */
    WB_GRBL_RATE = 110,         /* mm/min */
    WB_GRBL_ACCELERATION = 120, /* mm/s2 */
    WB_GRBL_TRAVEL = 130        /* mm */
};

enum wb_grbl_kind {
    WB_GRBL_LINE_EMPTY,
    WB_GRBL_LINE_OK,      /* ok */
    WB_GRBL_LINE_ERROR,   /* error:N */
    WB_GRBL_LINE_ALARM,   /* ALARM:N */
    WB_GRBL_LINE_BANNER,  /* Grbl 1.1h ['$' for help] */
    WB_GRBL_LINE_REPORT,  /* <Idle|MPos:...> */
    WB_GRBL_LINE_MESSAGE, /* [MSG:...] and other feedback in brackets */
    WB_GRBL_LINE_SETTING, /* $N=value */
    WB_GRBL_LINE_UNKNOWN
};

/* Fields of a status report. Positions are in mm ($13=0). */
struct wb_grbl_report {
    enum wb_stage_state state;
    char name[16]; /* as sent, "Hold:0" */
    bool has_machine, has_work, has_offset;
    double machine_mm[3], work_mm[3], offset_mm[3]; /* MPos, WPos, WCO */
    bool has_feed;
    double feed_mm_min; /* of FS or F */
    bool limit[3];      /* Pn: a limit switch is pressed */
};

struct wb_grbl_line {
    enum wb_grbl_kind kind;
    int number;    /* of error, alarm and setting */
    double value;  /* of a setting that is a number, NaN otherwise */
    char text[96]; /* printable copy, truncated */
    struct wb_grbl_report report;
};

/* Decodes a line of `length` bytes without its terminator. Any bytes are accepted; lines that are
 * not GRBL become WB_GRBL_LINE_UNKNOWN. */
void wb_grbl_decode(const char *bytes, size_t length, struct wb_grbl_line *line);

/* The last reported work offset; GRBL sends it every 10 to 30 reports. */
struct wb_grbl_offset {
    bool known;
    double mm[3];
};

/* Machine position of an axis (0 to 2), mm: MPos, or WPos + WCO with the stored offset, which is
 * updated. False while the position is unknown. */
bool wb_grbl_position(const struct wb_grbl_report *report, struct wb_grbl_offset *offset, int axis,
                      double *position_mm);

/* Meaning of an error or alarm number; never NULL. Alarm 0: the stage is locked because it was not
 * homed since it was switched on or reset. */
const char *wb_grbl_error_text(int number);
const char *wb_grbl_alarm_text(int number);

/* Writes the reason of a stage's alarm: "ALARM:1, hard limit: ...". */
void wb_grbl_alarm_reason(const struct wb_stage_report *report, char *text, size_t size);

/* True for alarms after which the position is lost. */
bool wb_grbl_alarm_loses_position(int number);

/* Formats a relative jog `$J=G91 G21 X2.000 F120.000` with its newline; distance in m, speed in
 * m/s. False if it does not fit, or if GRBL cannot execute it: a distance below its resolution of 1
 * um, or a speed below 1 um/min. */
bool wb_grbl_format_jog(char *text, size_t size, char axis, double distance, double speed);

/* Formats a status report with its line end, `<name|MPos:..|FS:..|WCO:..>`, with the fields of
 * `report` (for the virtual rig). Returns its length; 0: it does not fit. */
size_t wb_grbl_format_report(char *text, size_t size, const struct wb_grbl_report *report);

#endif
