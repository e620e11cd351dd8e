/* The log of load-cell checks: a CSV file next to the rig file (`bench.checks.csv` for
 * `bench.yaml`). Each check appends one line; existing lines are never changed:
 *
 *     utc,known_mass_g,read_mass_g,deviation_mg,deviation_percent,tolerance_percent,passed,
 *     serial_number
 *
 * The serial number is last because it is text that may contain commas.
 */
#ifndef WB_DAQ_TEST_CHECK_LOG_H
#define WB_DAQ_TEST_CHECK_LOG_H

#include <stdbool.h>

#include "base/file.h"
#include "base/status.h"

#define WB_CHECK_LOG_LINE 320

struct wb_check_log_entry {
    char utc[32];     /* ISO 8601 */
    double known;     /* kg, mass of the weight */
    double read;      /* kg, reading of the cell */
    double tolerance; /* as a fraction of the known mass */
    bool passed;
    char serial_number[64]; /* of the rig file; "" if it has none */
};

/* Path of the log; WB_ERR_ARGUMENT if it is too long. */
WB_MUST_CHECK enum wb_status wb_check_log_path(char path[WB_PATH], const char *rig_path);

/* Appends one line in a single write, in a new file after a heading. A last line truncated by a
 * power failure is ended first. */
WB_MUST_CHECK enum wb_status wb_check_log_append(const char *rig_path,
                                                 const struct wb_check_log_entry *entry);

/* The last complete line, without its line end; "" if there is no log or no check in it. A log that
 * cannot be read causes a warning and counts as missing. */
void wb_check_log_last(const char *rig_path, char line[WB_CHECK_LOG_LINE]);

/* Parses one line; false if it is not an entry. */
bool wb_check_log_parse(const char *line, struct wb_check_log_entry *entry);

/* s since the check; infinite if its date cannot be parsed. */
double wb_check_log_age(const struct wb_check_log_entry *entry);

/* Formats an entry: "2026-01-15T10:00:00Z, 10 g read 10.002 g (+0.020 %), LS270-1, passed". */
void wb_check_log_describe(const struct wb_check_log_entry *entry, char text[WB_CHECK_LOG_LINE]);

#endif
