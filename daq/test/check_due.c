#include "daq/test/check_due.h"

#include <stdio.h>
#include <string.h>

#include "base/timing.h"
#include "base/units.h"

/* s, tolerated difference between the clocks of computers that share a folder. */
#define CLOCK_DIFFERENCE 3600.0

enum wb_check_due wb_check_due(const struct wb_rig_load_cell *cell, const char *rig_path,
                               int64_t now_s, char text[WB_CHECK_DUE_TEXT])
{
    char line[WB_CHECK_LOG_LINE];
    struct wb_check_log_entry entry;
    int64_t then_s;
    text[0] = '\0';
    if (!(cell->check_due > 0.0))
        return WB_CHECK_DUE_HOLDS;
    const double days = cell->check_due / WB_DAY;
    wb_check_log_last(rig_path, line);
    if (!wb_check_log_parse(line, &entry) || !wb_time_parse(entry.utc, &then_s) ||
        strcmp(entry.serial_number, cell->serial_number) != 0) {
        snprintf(text, WB_CHECK_DUE_TEXT,
                 "check_due_days of '%s' is %g, but its log has no check of this load cell: run "
                 "'wirebench stage %s check'",
                 rig_path, days, rig_path);
        return WB_CHECK_DUE_TOO_LATE;
    }
    const double age = (double)(now_s - then_s);
    if (age < -CLOCK_DIFFERENCE) {
        snprintf(text, WB_CHECK_DUE_TEXT,
                 "the last check of the load cell, on %s, is later than this computer's clock: set "
                 "the clock, then run 'wirebench stage %s check'",
                 entry.utc, rig_path);
        return WB_CHECK_DUE_LATE;
    }
    if (age <= cell->check_due)
        return WB_CHECK_DUE_HOLDS;
    const bool refused = age > 2.0 * cell->check_due;
    snprintf(text, WB_CHECK_DUE_TEXT,
             "the last check of the load cell, on %s, is %.1f days old, and check_due_days of '%s' "
             "is %g%s: run 'wirebench stage %s check'",
             entry.utc, age / WB_DAY, rig_path, days,
             refused ? "; no test is started after twice that time" : "", rig_path);
    return refused ? WB_CHECK_DUE_TOO_LATE : WB_CHECK_DUE_LATE;
}
