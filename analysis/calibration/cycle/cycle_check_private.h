/* The two checks of cycle_check.h separately, for its tests. */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_PRIVATE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CHECK_PRIVATE_H

#include "analysis/calibration/cycle/cycle_check.h"

/* Checks the rows of n datasets of one wire before a calibration. At most one remark makes a
 * dataset unusable, that of the most basic check. */
void wb_cycle_check_data(struct wb_cycle_remarks *remarks, const struct wb_dataset *const *datasets,
                         int n);

/* Checks the results of a calibration; `datasets` are the same, in the same order. Computes a few
 * points of each specimen, and refits a specimen whose length is in doubt and cannot be checked
 * with markers. */
WB_MUST_CHECK enum wb_status wb_cycle_check_run(struct wb_cycle_remarks *remarks,
                                                const struct wb_cycle_calibration *calibration,
                                                const struct wb_dataset *const *datasets);

/* The first remark of at least this severity; NULL: none. */
const struct wb_cycle_remark *wb_cycle_check_find(const struct wb_cycle_remarks *remarks,
                                                  enum wb_cycle_check_severity severity);

/* WB_ERR_DATA if a remark is `unusable`; `why` receives the text of the first one, NULL: it is
 * logged. */
WB_MUST_CHECK enum wb_status wb_cycle_check_refuse(const struct wb_cycle_remarks *remarks,
                                                   struct wb_reason *why);

#endif
