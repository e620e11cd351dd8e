/* What is wrong with the data of a calibration on whole cycles, or makes its numbers doubtful: told
 * before a user relies on them.
 *
 * Rows alone show slips of units, a wrong length and a travel that is of no use; the fits show a
 * zero that is off, a specimen unlike the others, a law that does not follow. Each remark is one
 * sentence or two that name wire and sample, the number, what was expected, and how to mend it.
 *
 * What all specimens share leaves no trace and is not found: gain of the cell, diameter.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"

enum wb_cycle_check_severity {
    WB_CHECK_NOTE,    /* worth knowing; the numbers stand */
    WB_CHECK_DOUBT,   /* numbers may be wrong by more than their intervals say */
    WB_CHECK_UNUSABLE /* no properties may be made of this */
};

/* "note", "doubt", "unusable" */
const char *wb_cycle_check_severity_name(enum wb_cycle_check_severity severity);

enum {
    WB_CYCLE_MOST_REMARKS = 64
};

struct wb_cycle_remark {
    enum wb_cycle_check_severity severity;
    int sample; /* as in its dataset; 0: all specimens together */
    char text[768];
};

/* In the order of the checks; zeroed before the first. Those beyond the last are dropped. */
struct wb_cycle_remarks {
    int n;
    struct wb_cycle_remark items[WB_CYCLE_MOST_REMARKS];
};

/* A calibration between both checks: what is unusable is refused, before it or after it, and leaves
 * no calibration. */
WB_MUST_CHECK enum wb_status
wb_cycle_check_calibrate(struct wb_cycle_calibration *calibration, struct wb_cycle_remarks *remarks,
                         const struct wb_dataset *const *datasets, int n,
                         const struct wb_cycle_calibrate_settings *settings, struct wb_reason *why);

/* Appends the remarks to an array: severity, sample (null: all), text. */
void wb_cycle_check_put(struct wb_json *array, const struct wb_cycle_remarks *remarks);

#endif
