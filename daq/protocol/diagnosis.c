#include "daq/protocol/diagnosis.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "daq/protocol/cells.h"
#include "daq/protocol/grbl.h"
#include "daq/protocol/loadcell_line.h"

#define TEXT_SHARE 0.85  /* least fraction of printable bytes in text */
#define ENDLESS_BYTES 80 /* text of this length without a line end is not a line */

#define SWAPPED "load_cell.address and stage.address are probably swapped: exchange them"
#define NOT_LINES                                                                                  \
    "its bytes are not lines of text: set the baud rate in stage.address (GRBL 1.1: 115200)"

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

static bool has(struct wb_span line, const char *word)
{
    for (; line.n > 0; line.text++, line.n--)
        if (wb_cells_begins(line, word))
            return true;
    return false;
}

/* The next line from `at` that is not empty; false: no further line has ended. */
static bool next_line(const struct wb_diagnosis *diagnosis, size_t *at, struct wb_span *line)
{
    *line = (struct wb_span){diagnosis->bytes + *at, 0};
    while (*at < diagnosis->n) {
        const char c = diagnosis->bytes[(*at)++];
        if (c != '\n' && c != '\r')
            line->n++;
        else if (line->n > 0)
            return true;
        else
            line->text = diagnosis->bytes + *at;
    }
    return false;
}

static bool is_grbl(enum wb_diagnosis_kind kind)
{
    return kind == WB_DIAGNOSIS_GRBL || kind == WB_DIAGNOSIS_OLD_GRBL;
}

/* Kind of a line of text; OTHER if it is not recognised. */
static enum wb_diagnosis_kind judge_line(struct wb_span line)
{
    static const struct wb_rig_load_cell plain = {.scale = 1.0, .sign = 1};
    struct wb_grbl_line grbl;
    struct wb_line_reading reading;
    /* "<Idle,MPos:0.000,...": reports of version 0.9 have commas, those of 1.1 have bars. */
    if (wb_cells_begins(line, "Grbl 0.") || (wb_cells_begins(line, "<") && has(line, ",MPos:")))
        return WB_DIAGNOSIS_OLD_GRBL;
    if (has(line, "Marlin") || wb_cells_begins(line, "echo:") ||
        wb_cells_begins(line, "Error:Printer"))
        return WB_DIAGNOSIS_MARLIN;
    wb_grbl_decode(line.text, line.n, &grbl);
    if (grbl.kind == WB_GRBL_LINE_BANNER || grbl.kind == WB_GRBL_LINE_REPORT ||
        grbl.kind == WB_GRBL_LINE_ALARM)
        return WB_DIAGNOSIS_GRBL;
    wb_line_decode(line.text, line.n, &plain, &reading);
    return reading.kind == WB_LINE_VALUE ? WB_DIAGNOSIS_READINGS : WB_DIAGNOSIS_OTHER;
}

enum wb_diagnosis_kind wb_diagnosis_kind(const struct wb_diagnosis *diagnosis)
{
    int readings = 0, lines = 0;
    struct wb_span line;
    if (diagnosis->n == 0)
        return WB_DIAGNOSIS_NOTHING;
    if (!is_text(diagnosis))
        return WB_DIAGNOSIS_NOISE;
    for (size_t at = 0; next_line(diagnosis, &at, &line); lines++) {
        const enum wb_diagnosis_kind kind = judge_line(line);
        if (is_grbl(kind) || kind == WB_DIAGNOSIS_MARLIN)
            return kind;
        /* The first line may be incomplete. */
        readings += lines > 0 && kind == WB_DIAGNOSIS_READINGS;
    }
    if (lines == 0 && diagnosis->n >= ENDLESS_BYTES)
        return WB_DIAGNOSIS_ENDLESS;
    const int others = lines - 1 - readings;
    return readings >= 2 && readings > others ? WB_DIAGNOSIS_READINGS : WB_DIAGNOSIS_OTHER;
}

/* Whether the bytes contain line ends, but not those of the rig file. */
static bool lacks_terminator(const struct wb_diagnosis *load, const struct wb_rig *rig)
{
    const char *const terminator = rig->load_cell.terminator;
    if (strcmp(terminator, "crlf") == 0)
        return !has((struct wb_span){load->bytes, load->n}, "\r\n");
    if (strcmp(terminator, "cr") == 0)
        return !memchr(load->bytes, '\r', load->n);
    return strcmp(terminator, "lf") == 0 && !memchr(load->bytes, '\n', load->n);
}

/* Whether the second complete line is a number without a unit. */
static bool is_bare_number(const struct wb_diagnosis *load, const struct wb_rig *rig,
                           double *number)
{
    struct wb_line_reading reading;
    struct wb_span line;
    size_t at = 0;
    if (!next_line(load, &at, &line) || !next_line(load, &at, &line))
        return false;
    wb_line_decode(line.text, line.n, &rig->load_cell, &reading);
    *number = reading.value;
    return reading.kind == WB_LINE_VALUE && reading.unit[0] == '\0';
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
    double number;
    if (is_grbl(kind))
        snprintf(text, WB_DIAGNOSIS_TEXT, "a stage replies at this port: " SWAPPED);
    else if (wb_diagnosis_kind(stage) == WB_DIAGNOSIS_READINGS)
        snprintf(text, WB_DIAGNOSIS_TEXT, "a load cell sends at the stage's port: " SWAPPED);
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

/* Cause and remedy for a GRBL stage that does not report its status. */
static const char *const grbl_causes[] = {
    [WB_DIAGNOSIS_NOTHING] =
        "no data received: check power and cable, the port and the baud rate in stage.address "
        "(GRBL 1.1: 115200), and stage.protocol",
    [WB_DIAGNOSIS_NOISE] = NOT_LINES,
    [WB_DIAGNOSIS_ENDLESS] = NOT_LINES,
    [WB_DIAGNOSIS_GRBL] =
        "it is a GRBL 1.1 that does not reply to '?': check both directions of the cable, and "
        "flow= in stage.address",
    [WB_DIAGNOSIS_OLD_GRBL] =
        "it is a GRBL before 1.1, which cannot jog: install GRBL 1.1 on the controller "
        "(stage.protocol grbl)",
    [WB_DIAGNOSIS_MARLIN] =
        "it replies like Marlin, the firmware of 3D printers: stage.protocol grbl needs GRBL 1.1 "
        "on the controller",
    [WB_DIAGNOSIS_READINGS] = "it sends readings of a load cell: " SWAPPED,
    [WB_DIAGNOSIS_OTHER] =
        "its lines are not those of GRBL 1.1: check that stage.address is the stage's port, and "
        "stage.protocol",
};

void wb_diagnosis_stage(const struct wb_diagnosis *stage, const struct wb_rig *rig,
                        char text[WB_DIAGNOSIS_TEXT])
{
    const enum wb_diagnosis_kind kind = wb_diagnosis_kind(stage);
    if (strcmp(rig->stage.protocol, "tic") != 0 || kind == WB_DIAGNOSIS_READINGS)
        snprintf(text, WB_DIAGNOSIS_TEXT, "%s", grbl_causes[kind]);
    else if (is_grbl(kind))
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
