/* For the tests of predictions.h. */
#ifndef WB_ANALYSIS_REPORT_PREDICTIONS_PREDICTIONS_PRIVATE_H
#define WB_ANALYSIS_REPORT_PREDICTIONS_PREDICTIONS_PRIVATE_H

#include "analysis/report/predictions/predictions.h"

/* Judgement of a test from all places, as in docs/manual.md ('Judging a test of the bundle'). A
 * text that is static. */
const char *wb_predictions_judge(const struct wb_predictions_place places[WB_PREDICTIONS_PLACES]);

#endif
