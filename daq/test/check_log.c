#include "daq/test/check_log.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "base/number.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "check"

#define HEADING                                                                                    \
    "utc,known_mass_g,read_mass_g,deviation_mg,deviation_percent,tolerance_percent,passed,"        \
    "serial_number\n"
#define N_NUMBERS 5

enum wb_status wb_check_log_path(char path[WB_PATH], const char *rig_path)
{
    size_t n = strlen(rig_path);
    static const char *const endings[] = {".yaml", ".yml"};
    for (size_t i = 0; i < 2; i++) {
        const size_t n_ending = strlen(endings[i]);
        if (n > n_ending && strcmp(rig_path + n - n_ending, endings[i]) == 0) {
            n -= n_ending;
            break;
        }
    }
    if ((size_t)snprintf(path, WB_PATH, "%.*s.checks.csv", (int)n, rig_path) >= WB_PATH)
        return wb_fail(WB_ERR_ARGUMENT, "the path of the check log beside '%s' is too long",
                       rig_path);
    return WB_OK;
}

static void format(const struct wb_check_log_entry *entry, char line[WB_CHECK_LOG_LINE])
{
    char serial[sizeof entry->serial_number];
    size_t n = 0;
    for (; entry->serial_number[n]; n++)
        serial[n] = (unsigned char)entry->serial_number[n] < ' ' ? ' ' : entry->serial_number[n];
    serial[n] = '\0';
    const double deviation = entry->read - entry->known;
    snprintf(line, WB_CHECK_LOG_LINE, "%s,%.6g,%.6f,%.3f,%.4f,%.6g,%s,%s", entry->utc,
             entry->known / WB_G, entry->read / WB_G, deviation / WB_MG,
             deviation / entry->known / WB_PERCENT, entry->tolerance / WB_PERCENT,
             entry->passed ? "yes" : "no", serial);
}

/* Text to write before the new line: the heading of a new file, or the end of a truncated line. */
static const char *lead_in(int file)
{
    const off_t end = lseek(file, 0, SEEK_END);
    char last = '\n';
    if (end == 0)
        return HEADING;
    if (end > 0 && pread(file, &last, 1, end - 1) == 1 && last != '\n')
        return "\n";
    return "";
}

enum wb_status wb_check_log_append(const char *rig_path, const struct wb_check_log_entry *entry)
{
    char path[WB_PATH], line[WB_CHECK_LOG_LINE], text[WB_CHECK_LOG_LINE + sizeof HEADING + 1];
    WB_TRY(wb_check_log_path(path, rig_path));
    format(entry, line);
    const int file = open(path, O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0)
        return wb_fail(WB_ERR_IO, "the log of checks '%s' cannot be opened: %s", path,
                       strerror(errno));
    (void)flock(file, LOCK_EX); /* two processes that create the log must write one heading */
    const int n = snprintf(text, sizeof text, "%s%s\n", lead_in(file), line);
    const ssize_t written = write(file, text, (size_t)n);
    const int error = written < 0 ? errno : ENOSPC;
    const bool whole = written == n && fsync(file) == 0;
    close(file);
    if (!whole)
        return wb_fail(WB_ERR_IO, "the check cannot be added to '%s': %s", path, strerror(error));
    return WB_OK;
}

void wb_check_log_last(const char *rig_path, char line[WB_CHECK_LOG_LINE])
{
    char path[WB_PATH], *text;
    struct wb_check_log_entry entry;
    line[0] = '\0';
    if (wb_check_log_path(path, rig_path) != WB_OK || !wb_file_exists(path) ||
        wb_file_read(path, &text, NULL) != WB_OK)
        return;
    /* A line without a line end is incomplete. */
    for (char *at = text, *end; (end = strchr(at, '\n')); at = end + 1) {
        *end = '\0';
        if (end > at && end[-1] == '\r')
            end[-1] = '\0';
        if (strlen(at) < WB_CHECK_LOG_LINE && wb_check_log_parse(at, &entry))
            strcpy(line, at);
    }
    free(text);
}

/* The field up to the next comma; NULL when there is none. */
static const char *take_field(const char *at, char *field, size_t size)
{
    const char *const comma = strchr(at, ',');
    if (!comma || (size_t)(comma - at) >= size)
        return NULL;
    memcpy(field, at, (size_t)(comma - at));
    field[comma - at] = '\0';
    return comma + 1;
}

bool wb_check_log_parse(const char *line, struct wb_check_log_entry *entry)
{
    struct wb_check_log_entry read = {.utc = ""};
    double numbers[N_NUMBERS];
    char field[32];
    const char *at = take_field(line, read.utc, sizeof read.utc);
    for (int i = 0; at && i < N_NUMBERS; i++) {
        at = take_field(at, field, sizeof field);
        if (at && !wb_number_parse(field, &numbers[i]))
            return false;
    }
    at = at ? take_field(at, field, sizeof field) : NULL;
    if (!at || !(numbers[0] > 0.0) || strlen(at) >= sizeof read.serial_number)
        return false;
    read.passed = strcmp(field, "yes") == 0;
    if (!read.passed && strcmp(field, "no") != 0)
        return false;
    read.known = numbers[0] * WB_G;
    read.read = numbers[1] * WB_G;
    read.tolerance = numbers[4] * WB_PERCENT;
    strcpy(read.serial_number, at);
    *entry = read;
    return true;
}

double wb_check_log_age(const struct wb_check_log_entry *entry)
{
    int64_t utc;
    return wb_time_parse(entry->utc, &utc) ? (double)(wb_time_utc() - utc) : HUGE_VAL;
}

void wb_check_log_describe(const struct wb_check_log_entry *entry, char text[WB_CHECK_LOG_LINE])
{
    snprintf(text, WB_CHECK_LOG_LINE, "%s, %g g read %.4f g (%+.3f %%), %s, %s", entry->utc,
             entry->known / WB_G, entry->read / WB_G,
             (entry->read - entry->known) / entry->known / WB_PERCENT,
             entry->serial_number[0] ? entry->serial_number : "no serial number",
             entry->passed ? "passed" : "NOT PASSED");
}
