/* The log of load-cell checks: a CSV file beside the rig file (`bench.yaml` has
 * `bench.checks.csv`), one line a check, appended and never rewritten:
 *
 *     utc,known_mass_g,read_mass_g,deviation_mg,deviation_percent,tolerance_percent,passed,
 *     serial_number
 *
 * The serial number comes last, because it is text and may hold anything but a line break.
 */
#ifndef WB_DAQ_TEST_CHECK_LOG_H
#define WB_DAQ_TEST_CHECK_LOG_H

#include <stdbool.h>

#include "base/file.h"
#include "base/status.h"

#define WB_CHECK_LOG_LINE 320

struct wb_check_log_entry {
    char utc[32];     /* ISO 8601 */
    double known;     /* kg, the mass that was hung */
    double read;      /* kg, what the cell read */
    double tolerance; /* fraction of the known mass */
    bool passed;
    char serial_number[64]; /* "" where the rig file has none */
};

/* The log's path; WB_ERR_ARGUMENT when it gets too long. */
WB_MUST_CHECK enum wb_status wb_check_log_path(char path[WB_PATH], const char *rig_path);

/* Appends one line in one write, after a heading where the file is new; a last line that was cut
 * short (a power failure) is ended first. */
WB_MUST_CHECK enum wb_status wb_check_log_append(const char *rig_path,
                                                 const struct wb_check_log_entry *entry);

/* The last complete line, without its line end; "" when there is no log or no check in it. A log
 * that cannot be read is a warning and as good as none. */
void wb_check_log_last(const char *rig_path, char line[WB_CHECK_LOG_LINE]);

/* One line to an entry; false when it is none. */
bool wb_check_log_parse(const char *line, struct wb_check_log_entry *entry);

/* s since the check; infinite where its time cannot be read. */
double wb_check_log_age(const struct wb_check_log_entry *entry);

/* "2026-01-15T10:00:00Z, 10 g read 10.002 g (+0.020 %), LS270-1, passed". */
void wb_check_log_describe(const struct wb_check_log_entry *entry, char text[WB_CHECK_LOG_LINE]);

#endif
