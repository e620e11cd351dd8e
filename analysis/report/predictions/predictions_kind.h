/* The report of predictions of bundles with bands. */
#ifndef WB_ANALYSIS_REPORT_PREDICTIONS_PREDICTIONS_KIND_H
#define WB_ANALYSIS_REPORT_PREDICTIONS_PREDICTIONS_KIND_H

#include "analysis/keys/keys.h"
#include "analysis/report/kind.h"
#include "analysis/report/predictions/predictions.h"

/* Campaign and results: struct wb_predictions, struct wb_predictions_results. */
extern const struct wb_kind wb_predictions_kind;

/* Keys of its report.json. */
extern const struct wb_keys wb_predictions_kind_keys;

#endif
