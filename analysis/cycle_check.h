/* What is wrong with the data of a calibration on whole cycles, or makes its numbers doubtful: told
 * before a user relies on them.
 *
 * Rows alone show slips of units, a wrong length and a travel that is of no use; the fits show a
 * zero that is off, a specimen unlike the others, a law that does not follow. Each remark is one
 * sentence or two that name wire and sample, the number, what was expected, and how to mend it.
 *
 * What all specimens share leaves no trace and is not found: gain of the cell, diameter.
 */
#ifndef WB_ANALYSIS_CYCLE_CHECK_H
#define WB_ANALYSIS_CYCLE_CHECK_H

#include "analysis/cycle_calibrate.h"
#include "analysis/dataset.h"
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

/* Checks the rows of n datasets of one wire, before a calibration. At most one remark that makes a
 * dataset unusable, the plainest. Fails only without memory. */
WB_MUST_CHECK enum wb_status wb_cycle_check_data(struct wb_cycle_remarks *remarks,
                                                 const struct wb_dataset *const *datasets, int n);

/* Checks what a calibration made of them; `datasets` are the same, in the same order. It computes
 * a few points of each specimen, and refits one whose length is in doubt and cannot be seen. Fails
 * only without memory. */
WB_MUST_CHECK enum wb_status wb_cycle_check_run(struct wb_cycle_remarks *remarks,
                                                const struct wb_cycle_calibration *calibration,
                                                const struct wb_dataset *const *datasets);

/* The first remark of at least this severity; NULL: none. */
const struct wb_cycle_remark *wb_cycle_check_find(const struct wb_cycle_remarks *remarks,
                                                  enum wb_cycle_check_severity severity);

/* WB_ERR_DATA with the first unusable remark's text where there is one. `why` receives it; NULL: it
 * is logged. */
WB_MUST_CHECK enum wb_status wb_cycle_check_refuse(const struct wb_cycle_remarks *remarks,
                                                   struct wb_reason *why);

#endif
