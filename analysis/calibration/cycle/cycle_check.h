/* Checks of the data and results of a calibration on whole cycles. Errors, and doubts about
 * results, are reported before a user relies on them.
 *
 * Rows alone show wrong units, a wrong length and a travel that is too short; the fits show a wrong
 * zero, a specimen that differs from the others, and a law with a large misfit. Each remark is one
 * or two sentences with wire and sample, the number, the expected one, and what to do.
 *
 * Errors of the cell's gain and of the diameter are the same in all specimens and cannot be found.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"

enum wb_cycle_check_severity {
    WB_CHECK_NOTE,    /* worth knowing; the results are valid */
    WB_CHECK_DOUBT,   /* results may be wrong by more than their intervals */
    WB_CHECK_UNUSABLE /* no calibration is possible */
};

/* "note", "doubt", "unusable" */
const char *wb_cycle_check_severity_name(enum wb_cycle_check_severity severity);

enum {
    WB_CYCLE_MOST_REMARKS = 64
};

struct wb_cycle_remark {
    enum wb_cycle_check_severity severity;
    int sample; /* as in its dataset; 0: all specimens */
    char text[768];
};

/* In the order of the checks. The caller zeroes the struct first; remarks beyond the capacity are
 * dropped. */
struct wb_cycle_remarks {
    int n;
    struct wb_cycle_remark items[WB_CYCLE_MOST_REMARKS];
};

/* Runs the checks of the rows, the calibration and the checks of the fits. Unusable data:
 * WB_ERR_DATA, and no calibration. */
WB_MUST_CHECK enum wb_status
wb_cycle_check_calibrate(struct wb_cycle_calibration *calibration, struct wb_cycle_remarks *remarks,
                         const struct wb_dataset *const *datasets, int n,
                         const struct wb_cycle_calibrate_settings *settings, struct wb_reason *why);

/* Appends the remarks to an array: severity, sample (null: all), text. */
void wb_cycle_check_put(struct wb_json *array, const struct wb_cycle_remarks *remarks);

#endif
