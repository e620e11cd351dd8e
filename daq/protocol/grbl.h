/* GRBL 1.1, the firmware of stepper stages: its lines, as pure functions on text, and their
 * formatting for the virtual rig.
 *
 * GRBL answers each line it is sent with `ok` or `error:N`, in order. In between it pushes status
 * reports (the answer to the real-time byte `?`), `ALARM:N`, messages and its banner.
 */
#ifndef WB_DAQ_PROTOCOL_GRBL_H
#define WB_DAQ_PROTOCOL_GRBL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/sample.h"

/* Real-time bytes: obeyed at once, never answered by `ok`. */
enum {
    WB_GRBL_STATUS = '?',
    WB_GRBL_HOLD = '!',
    WB_GRBL_RESUME = '~',
    WB_GRBL_SOFT_RESET = 0x18,
    WB_GRBL_JOG_CANCEL = 0x85
};

/* Numbers of `$` settings; of the last four the first axis's, the others follow. */
enum {
    WB_GRBL_IDLE_DELAY = 1,  /* ms until the motors are switched off after a motion, */
    WB_GRBL_ALWAYS_ON = 255, /* never with this value */
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

/* Fields of a status report. Positions are in millimetres, as sent ($13=0). */
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
    char text[96]; /* printable copy, cut to fit */
    struct wb_grbl_report report;
};

/* Classifies one line of `length` bytes without its terminator. Anything is accepted: what is not
 * GRBL is WB_GRBL_LINE_UNKNOWN. */
void wb_grbl_decode(const char *bytes, size_t length, struct wb_grbl_line *line);

/* The work offset of the last report that had one; GRBL sends it every 10 to 30 reports. */
struct wb_grbl_offset {
    bool known;
    double mm[3];
};

/* Machine position of axis 0 to 2 in mm: MPos, or WPos + WCO with the cached offset, which is
 * brought up to date. False while it is not known. */
bool wb_grbl_position(const struct wb_grbl_report *report, struct wb_grbl_offset *offset, int axis,
                      double *position_mm);

/* What an error or alarm number means, in a few words; never NULL. No alarm number, 0, is a stage
 * that is locked because it was not homed since it was switched on or reset. */
const char *wb_grbl_error_text(int number);
const char *wb_grbl_alarm_text(int number);

/* Why a stage in state Alarm is in it, "ALARM:1, hard limit: ..." */
void wb_grbl_alarm_reason(const struct wb_stage_report *report, char *text, size_t size);

/* True for alarms after which the firmware no longer knows where the stage is. */
bool wb_grbl_alarm_loses_position(int number);

/* A relative jog `$J=G91 G21 X2.000 F120.000` with its newline; distance in m, speed in m/s.
 * False when it does not fit or GRBL could not do it: nothing to move in its resolution of 1 um,
 * or a speed below 1 um a minute. */
bool wb_grbl_format_jog(char *text, size_t size, char axis, double distance, double speed);

/* A status report with its line end, `<name|MPos:..|FS:..|WCO:..>`, of the fields the report has
 * (for the virtual rig). Returns its length, 0 when it does not fit. */
size_t wb_grbl_format_report(char *text, size_t size, const struct wb_grbl_report *report);

#endif
