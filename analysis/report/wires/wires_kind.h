/* The report of a comparison: a wire as a solid and as a rod. */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_KIND_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_KIND_H

#include "analysis/report/kind.h"
#include "analysis/report/wires/wires_results.h"

/* Campaign and results: struct wb_wires, struct wb_wires_results. */
extern const struct wb_kind wb_wires_kind;

#endif
