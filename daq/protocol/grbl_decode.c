#include "daq/protocol/grbl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/number.h"
#include "daq/protocol/driver.h"

#define MM_PER_M 1e3
#define S_PER_MIN 60.0

/* Parses 1 to 4 digits. */
static bool parse_number(const char *text, int *number)
{
    const size_t n = strspn(text, "0123456789");
    if (n == 0 || n > 4 || text[n] != '\0')
        return false;
    *number = atoi(text);
    return true;
}

/* Parses up to three numbers separated by commas; returns their number, 0 if one is invalid. */
static int parse_triple(const char *text, double values[3])
{
    char copy[96], *rest = copy;
    if (strlen(text) >= sizeof copy)
        return 0;
    strcpy(copy, text);
    int n = 0;
    for (const char *part; n < 3 && (part = strsep(&rest, ",")); n++)
        if (!wb_number_parse(part, &values[n]))
            return 0;
    return n;
}

static enum wb_stage_state state_of(const char *name)
{
    static const struct {
        const char *name;
        enum wb_stage_state state;
    } states[] = {
        {"Idle", WB_STAGE_IDLE},  {"Run", WB_STAGE_RUN},     {"Jog", WB_STAGE_JOG},
        {"Hold", WB_STAGE_HOLD},  {"Home", WB_STAGE_HOME},   {"Alarm", WB_STAGE_ALARM},
        {"Door", WB_STAGE_OTHER}, {"Check", WB_STAGE_OTHER}, {"Sleep", WB_STAGE_OTHER},
    };
    const size_t length = strcspn(name, ":");
    for (size_t i = 0; i < WB_COUNT(states); i++)
        if (strlen(states[i].name) == length && strncmp(name, states[i].name, length) == 0)
            return states[i].state;
    return WB_STAGE_UNKNOWN;
}

/* Parses a field of a report, "MPos:0.000,0.000,0.000". Unknown fields are ignored. */
static bool parse_field(const char *field, struct wb_grbl_report *report)
{
    static const char *const names[] = {"MPos:", "WPos:", "WCO:"};
    double *const triples[] = {report->machine_mm, report->work_mm, report->offset_mm};
    bool *const has[] = {&report->has_machine, &report->has_work, &report->has_offset};
    double values[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < WB_COUNT(names); i++)
        if (strncmp(field, names[i], strlen(names[i])) == 0)
            return *has[i] = parse_triple(field + strlen(names[i]), triples[i]) > 0;
    if (strncmp(field, "FS:", 3) == 0 || strncmp(field, "F:", 2) == 0) {
        if (parse_triple(strchr(field, ':') + 1, values) == 0)
            return false;
        report->feed_mm_min = values[0];
        report->has_feed = true;
    } else if (strncmp(field, "Pn:", 3) == 0) {
        for (int axis = 0; axis < 3; axis++)
            report->limit[axis] = strchr(field + 3, "XYZ"[axis]) != NULL;
    }
    return true;
}

/* Parses the contents of <...>. */
static bool parse_report(char *text, struct wb_grbl_report *report)
{
    char *rest = text;
    const char *const name = strsep(&rest, "|");
    report->state = state_of(name);
    if (report->state == WB_STAGE_UNKNOWN || strlen(name) >= sizeof report->name)
        return false;
    strcpy(report->name, name);
    for (const char *field; (field = strsep(&rest, "|"));)
        if (!parse_field(field, report))
            return false;
    return true;
}

static void parse_setting(char *text, struct wb_grbl_line *line)
{
    char *value = text;
    const char *const number = strsep(&value, "=");
    if (!value || !parse_number(number, &line->number))
        return;
    line->kind = WB_GRBL_LINE_SETTING;
    if (!wb_number_parse(value, &line->value))
        line->value = (double)NAN;
}

/* The text after `word`, case-insensitive because firmware variants differ; NULL if it is missing.
 */
static const char *after(const char *text, const char *word)
{
    const size_t n = strlen(word);
    return strncasecmp(text, word, n) == 0 ? text + n : NULL;
}

static void classify(char *text, struct wb_grbl_line *line)
{
    const char *rest;
    const size_t length = strlen(text);
    if (length == 0) {
        line->kind = WB_GRBL_LINE_EMPTY;
    } else if (strcmp(text, "ok") == 0) {
        line->kind = WB_GRBL_LINE_OK;
    } else if ((rest = after(text, "error:"))) {
        if (parse_number(rest, &line->number))
            line->kind = WB_GRBL_LINE_ERROR;
    } else if ((rest = after(text, "ALARM:"))) {
        if (parse_number(rest, &line->number))
            line->kind = WB_GRBL_LINE_ALARM;
    } else if (after(text, "Grbl ")) {
        line->kind = WB_GRBL_LINE_BANNER;
    } else if (text[0] == '<' && text[length - 1] == '>') {
        text[length - 1] = '\0';
        if (parse_report(text + 1, &line->report))
            line->kind = WB_GRBL_LINE_REPORT;
        else
            memset(&line->report, 0, sizeof line->report);
    } else if (text[0] == '[' && text[length - 1] == ']') {
        line->kind = WB_GRBL_LINE_MESSAGE;
    } else if (text[0] == '$') {
        parse_setting(text + 1, line);
    }
}

void wb_grbl_decode(const char *bytes, size_t length, struct wb_grbl_line *line)
{
    char text[256];
    memset(line, 0, sizeof *line);
    line->kind = WB_GRBL_LINE_UNKNOWN;
    line->value = (double)NAN;
    while (length > 0 && (bytes[length - 1] == '\r' || bytes[length - 1] == ' '))
        length--;
    wb_driver_printable(line->text, sizeof line->text, bytes, length);
    wb_driver_printable(text, sizeof text, bytes, length);
    if (length < sizeof text)
        classify(text, line);
}

bool wb_grbl_position(const struct wb_grbl_report *report, struct wb_grbl_offset *offset, int axis,
                      double *position_mm)
{
    if (report->has_offset) {
        offset->known = true;
        memcpy(offset->mm, report->offset_mm, sizeof offset->mm);
    }
    if (report->has_machine)
        *position_mm = report->machine_mm[axis];
    else if (report->has_work && offset->known)
        *position_mm = report->work_mm[axis] + offset->mm[axis];
    else
        return false;
    return true;
}

/* Text of a number, or a general one for numbers that are not listed. */
static const char *text_of(const char *const *texts, size_t n, int number)
{
    const char *const text = number >= 0 && (size_t)number < n ? texts[number] : NULL;
    return text ? text : "see the GRBL manual";
}

const char *wb_grbl_error_text(int number)
{
    static const char *const texts[] = {
        [1] = "a word has no letter",
        [2] = "a number is malformed",
        [3] = "unknown $ command",
        [5] = "homing is not enabled ($22)",
        [7] = "the stored settings could not be read",
        [8] = "only possible when idle",
        [9] = "locked out during an alarm or jog",
        [10] = "soft limits need homing",
        [11] = "the line is too long",
        [13] = "the safety door is open",
        [15] = "the jog exceeds the machine's travel",
        [16] = "the jog command is malformed",
        [20] = "the command is not supported",
        [22] = "no feed rate was given",
    };
    return text_of(texts, WB_COUNT(texts), number);
}

const char *wb_grbl_alarm_text(int number)
{
    static const char *const texts[] = {
        [0] = "it was not homed since it was switched on or reset",
        [1] = "hard limit: the position is lost, home the stage",
        [2] = "soft limit: the move exceeds the machine's travel",
        [3] = "reset while moving: the position is lost, home the stage",
        [4] = "probe failed",
        [5] = "probe failed",
        [6] = "homing failed: reset while homing",
        [7] = "homing failed: door opened while homing",
        [8] = "homing failed: the limit switch did not clear",
        [9] = "homing failed: no limit switch found",
    };
    return text_of(texts, WB_COUNT(texts), number);
}

void wb_grbl_alarm_reason(const struct wb_stage_report *report, char *text, size_t size)
{
    if (report->alarm > 0)
        snprintf(text, size, "ALARM:%d, %s", report->alarm, wb_grbl_alarm_text(report->alarm));
    else if (report->was_reset)
        snprintf(text, size,
                 "its controller restarted when the port was opened and lost its position; an "
                 "Arduino restarts at the first opening after plugging in, and at each opening if "
                 "stage.address has dtr=on or dtr=off");
    else
        snprintf(text, size, "locked: %s", wb_grbl_alarm_text(0));
}

bool wb_grbl_alarm_loses_position(int number)
{
    return number == 1 || number == 3 || (number >= 6 && number <= 9);
}

/* Formats a number given in thousandths, independent of the locale: "-2.000". */
static int format_thousandths(char *text, size_t size, long long value)
{
    const long long magnitude = value < 0 ? -value : value;
    return snprintf(text, size, "%s%lld.%03lld", value < 0 ? "-" : "", magnitude / 1000,
                    magnitude % 1000);
}

bool wb_grbl_format_jog(char *text, size_t size, char axis, double distance, double speed)
{
    const double um = distance * MM_PER_M * 1e3;
    const double um_min = speed * MM_PER_M * S_PER_MIN * 1e3;
    if (!(fabs(um) < 1e9) || !(um_min >= 1.0) || !(um_min < 1e12) || llround(um) == 0)
        return false;
    char target[32], feed[32];
    format_thousandths(target, sizeof target, llround(um));
    format_thousandths(feed, sizeof feed, llround(um_min));
    const int n = snprintf(text, size, "$J=G91 G21 %c%s F%s\n", axis, target, feed);
    return n > 0 && (size_t)n < size;
}

size_t wb_grbl_format_report(char *text, size_t size, const struct wb_grbl_report *report)
{
    static const char *const labels[] = {"MPos", "WPos", "WCO"};
    const double *const values[] = {report->machine_mm, report->work_mm, report->offset_mm};
    const bool has[] = {report->has_machine, report->has_work, report->has_offset};
    char line[256];
    size_t n = (size_t)snprintf(line, sizeof line, "<%s", report->name);
    for (int i = 0; i < 3; i++) {
        /* Order of the fields in GRBL: position, feed, pins, work offset. */
        if (i == 2) {
            n += (size_t)snprintf(line + n, sizeof line - n, "|FS:%lld,0",
                                  llround(report->feed_mm_min));
            if (report->limit[0] || report->limit[1] || report->limit[2])
                n += (size_t)snprintf(line + n, sizeof line - n, "|Pn:%s%s%s",
                                      report->limit[0] ? "X" : "", report->limit[1] ? "Y" : "",
                                      report->limit[2] ? "Z" : "");
        }
        if (!has[i])
            continue;
        n += (size_t)snprintf(line + n, sizeof line - n, "|%s:", labels[i]);
        for (int axis = 0; axis < 3; axis++) {
            if (!(fabs(values[i][axis]) < 1e6))
                return 0;
            if (axis)
                line[n++] = ',';
            n += (size_t)format_thousandths(line + n, sizeof line - n,
                                            llround(values[i][axis] * 1e3));
        }
    }
    n += (size_t)snprintf(line + n, sizeof line - n, ">\r\n");
    if (n >= sizeof line || n >= size)
        return 0;
    memcpy(text, line, n + 1);
    return n;
}
