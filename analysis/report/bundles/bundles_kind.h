/* The report of taped bundles: explicit 3D runs, and the 1D beams fitted to them. */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_KIND_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_KIND_H

#include "analysis/report/bundles/bundles_results.h"
#include "analysis/report/kind.h"

/* Campaign and results: struct wb_bundles, struct wb_bundles_results. */
extern const struct wb_kind wb_bundles_kind;

#endif
