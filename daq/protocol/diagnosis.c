#include "daq/protocol/diagnosis.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "daq/protocol/grbl.h"
#include "daq/protocol/loadcell_line.h"

#define TEXT_SHARE 0.85  /* least fraction of printable bytes in text */
#define ENDLESS_BYTES 80 /* text of this length without a line end is not a line */

void wb_diagnosis_add(struct wb_diagnosis *diagnosis, const void *bytes, size_t n)
{
    const size_t room = sizeof diagnosis->bytes - diagnosis->n;
    const size_t taken = n < room ? n : room;
    memcpy(diagnosis->bytes + diagnosis->n, bytes, taken);
    diagnosis->n += taken;
}

static bool is_text(const struct wb_diagnosis *diagnosis)
{
    size_t printable = 0;
    for (size_t i = 0; i < diagnosis->n; i++) {
        const char c = diagnosis->bytes[i];
        printable += (c >= 0x20 && c < 0x7f) || c == '\r' || c == '\n' || c == '\t';
    }
    return (double)printable >= TEXT_SHARE * (double)diagnosis->n;
}

static bool begins(const char *line, size_t n, const char *word)
{
    return n >= strlen(word) && strncasecmp(line, word, strlen(word)) == 0;
}

static bool has(const char *line, size_t n, const char *word)
{
    for (size_t i = 0; i < n; i++)
        if (begins(line + i, n - i, word))
            return true;
    return false;
}

/* Kind of a line of text; OTHER if it is not recognised. */
static enum wb_diagnosis_kind judge_line(const char *line, size_t n)
{
    static const struct wb_rig_load_cell plain = {.scale = 1.0, .sign = 1};
    struct wb_grbl_line grbl;
    struct wb_line_reading reading;
    /* "<Idle,MPos:0.000,...": reports of version 0.9 have commas, those of 1.1 have bars. */
    if (begins(line, n, "Grbl 0.") || (begins(line, n, "<") && has(line, n, ",MPos:")))
        return WB_DIAGNOSIS_OLD_GRBL;
    if (has(line, n, "Marlin") || begins(line, n, "echo:") || begins(line, n, "Error:Printer"))
        return WB_DIAGNOSIS_MARLIN;
    wb_grbl_decode(line, n, &grbl);
    if (grbl.kind == WB_GRBL_LINE_BANNER || grbl.kind == WB_GRBL_LINE_REPORT ||
        grbl.kind == WB_GRBL_LINE_ALARM)
        return WB_DIAGNOSIS_GRBL;
    wb_line_decode(line, n, &plain, &reading);
    return reading.kind == WB_LINE_VALUE ? WB_DIAGNOSIS_READINGS : WB_DIAGNOSIS_OTHER;
}

enum wb_diagnosis_kind wb_diagnosis_kind(const struct wb_diagnosis *diagnosis)
{
    int readings = 0, others = 0;
    size_t begin = 0, lines = 0;
    if (diagnosis->n == 0)
        return WB_DIAGNOSIS_NOTHING;
    if (!is_text(diagnosis))
        return WB_DIAGNOSIS_NOISE;
    for (size_t i = 0; i < diagnosis->n; i++) {
        if (diagnosis->bytes[i] != '\n' && diagnosis->bytes[i] != '\r')
            continue;
        const enum wb_diagnosis_kind kind = judge_line(diagnosis->bytes + begin, i - begin);
        if (kind == WB_DIAGNOSIS_GRBL || kind == WB_DIAGNOSIS_OLD_GRBL ||
            kind == WB_DIAGNOSIS_MARLIN)
            return kind;
        /* The first line may be incomplete. */
        if (i > begin && lines > 0) {
            readings += kind == WB_DIAGNOSIS_READINGS;
            others += kind != WB_DIAGNOSIS_READINGS;
        }
        lines += i > begin;
        begin = i + 1;
    }
    if (lines == 0 && diagnosis->n >= ENDLESS_BYTES)
        return WB_DIAGNOSIS_ENDLESS;
    return readings >= 2 && readings > others ? WB_DIAGNOSIS_READINGS : WB_DIAGNOSIS_OTHER;
}

static const char *const swapped =
    "load_cell.address and stage.address are probably swapped: exchange them";

/* Whether the bytes contain line ends, but not those of the rig file. */
static bool lacks_terminator(const struct wb_diagnosis *load, const struct wb_rig *rig)
{
    const char *const terminator = rig->load_cell.terminator;
    if (strcmp(terminator, "crlf") == 0)
        return !has(load->bytes, load->n, "\r\n");
    if (strcmp(terminator, "cr") == 0)
        return !memchr(load->bytes, '\r', load->n);
    return strcmp(terminator, "lf") == 0 && !memchr(load->bytes, '\n', load->n);
}

/* Whether the second complete line is a number without a unit. */
static bool is_bare_number(const struct wb_diagnosis *load, const struct wb_rig *rig,
                           double *number)
{
    struct wb_line_reading reading;
    size_t begin = 0;
    for (size_t i = 0, lines = 0; i < load->n; i++) {
        if (load->bytes[i] != '\n' && load->bytes[i] != '\r')
            continue;
        if (i > begin && ++lines == 2) {
            wb_line_decode(load->bytes + begin, i - begin, &rig->load_cell, &reading);
            *number = reading.value;
            return reading.kind == WB_LINE_VALUE && reading.unit[0] == '\0';
        }
        begin = i + 1;
    }
    return false;
}

/* Diagnoses numbers without a unit. */
static void diagnose_numbers(double number, const struct wb_rig *rig, char text[WB_DIAGNOSIS_TEXT])
{
    const char *const unit = rig->load_cell.unit;
    if (unit[0])
        snprintf(
            text, WB_DIAGNOSIS_TEXT,
            "its numbers, such as %g, exceed the cell's range in %s: if they are raw counts of a "
            "converter, set load_cell.scale (%s per count, from a known mass) and load_cell.offset",
            number, unit, unit);
    else
        snprintf(
            text, WB_DIAGNOSIS_TEXT,
            "its lines are numbers without a unit, such as %g: set load_cell.unit and, for raw "
            "counts of a converter, load_cell.scale and load_cell.offset",
            number);
}

void wb_diagnosis_load(const struct wb_diagnosis *load, const struct wb_diagnosis *stage,
                       const struct wb_rig *rig, char text[WB_DIAGNOSIS_TEXT])
{
    const enum wb_diagnosis_kind kind = wb_diagnosis_kind(load);
    const bool is_grbl = kind == WB_DIAGNOSIS_GRBL || kind == WB_DIAGNOSIS_OLD_GRBL;
    double number;
    if (is_grbl || wb_diagnosis_kind(stage) == WB_DIAGNOSIS_READINGS)
        snprintf(text, WB_DIAGNOSIS_TEXT, "%s: %s",
                 is_grbl ? "a stage replies at this port" : "a load cell sends at the stage's port",
                 swapped);
    else if (kind == WB_DIAGNOSIS_NOTHING)
        snprintf(
            text, WB_DIAGNOSIS_TEXT,
            "check power and cable, the baud rate in load_cell.address, and whether it must be "
            "polled (load_cell.poll_command, load_cell.poll_period_ms)");
    else if (kind == WB_DIAGNOSIS_NOISE)
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "its bytes are not text: set baud rate and frame in load_cell.address (such as "
                 "9600,8n1) as in the instrument's menu");
    else if (kind == WB_DIAGNOSIS_ENDLESS || lacks_terminator(load, rig))
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "its line ends are not those of load_cell.terminator: set it to any or, if there "
                 "are no line ends, to idle");
    else if (is_bare_number(load, rig, &number))
        diagnose_numbers(number, rig, text);
    else
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "check load_cell.protocol, its line settings (delimiter, column, decimal_comma) "
                 "and its unit");
}

static void diagnose_tic(enum wb_diagnosis_kind kind, char text[WB_DIAGNOSIS_TEXT])
{
    if (kind == WB_DIAGNOSIS_GRBL || kind == WB_DIAGNOSIS_OLD_GRBL)
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "it is a GRBL, not a Tic: set stage.protocol: grbl, and stage.axis");
    else
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "%s: check power and cable (TX, RX and ground), the baud rate in stage.address "
                 "(Tic: 9600 unless changed), and in Tic Control Center that the control mode is "
                 "Serial / I2C / USB and CRC and 7-bit responses are off",
                 kind == WB_DIAGNOSIS_NOTHING ? "no data received"
                                              : "the received bytes are not a reply of a Tic");
}

void wb_diagnosis_stage(const struct wb_diagnosis *stage, const struct wb_rig *rig,
                        char text[WB_DIAGNOSIS_TEXT])
{
    const enum wb_diagnosis_kind kind = wb_diagnosis_kind(stage);
    if (strcmp(rig->stage.protocol, "tic") == 0 && kind != WB_DIAGNOSIS_READINGS) {
        diagnose_tic(kind, text);
        return;
    }
    switch (kind) {
    case WB_DIAGNOSIS_NOTHING:
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "no data received: check power and cable, the port and the baud rate in "
                 "stage.address (GRBL 1.1: 115200), and stage.protocol");
        break;
    case WB_DIAGNOSIS_NOISE:
    case WB_DIAGNOSIS_ENDLESS:
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "its bytes are not lines of text: set the baud rate in stage.address (GRBL 1.1: "
                 "115200)");
        break;
    case WB_DIAGNOSIS_OLD_GRBL:
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "it is a GRBL before 1.1, which cannot jog: install GRBL 1.1 on the controller "
                 "(stage.protocol %s)",
                 rig->stage.protocol);
        break;
    case WB_DIAGNOSIS_MARLIN:
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "it replies like Marlin, the firmware of 3D printers: stage.protocol %s needs "
                 "GRBL 1.1 on the controller",
                 rig->stage.protocol);
        break;
    case WB_DIAGNOSIS_READINGS:
        snprintf(text, WB_DIAGNOSIS_TEXT, "it sends readings of a load cell: %s", swapped);
        break;
    case WB_DIAGNOSIS_GRBL:
        snprintf(text, WB_DIAGNOSIS_TEXT,
                 "it is a GRBL 1.1 that does not reply to '?': check both directions of the cable, "
                 "and flow= in stage.address");
        break;
    case WB_DIAGNOSIS_OTHER:
        snprintf(
            text, WB_DIAGNOSIS_TEXT,
            "its lines are not those of GRBL 1.1: check that stage.address is the stage's port, "
            "and stage.protocol");
        break;
    }
}
