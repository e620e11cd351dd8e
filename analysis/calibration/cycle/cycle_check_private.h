/* The two checks of analysis/cycle_check.h by themselves, for its tests. */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_PRIVATE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_PRIVATE_H

#include "analysis/calibration/cycle/cycle_check.h"

/* Checks the rows of n datasets of one wire, before a calibration. At most one remark that makes a
 * dataset unusable, the plainest. */
void wb_cycle_check_data(struct wb_cycle_remarks *remarks, const struct wb_dataset *const *datasets,
                         int n);

/* Checks what a calibration made of them; `datasets` are the same, in the same order. It computes
 * a few points of each specimen, and refits one whose length is in doubt and cannot be seen. */
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
