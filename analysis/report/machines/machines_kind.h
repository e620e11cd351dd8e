/* The report of a campaign of testing machines. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_KIND_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_KIND_H

#include "analysis/report/kind.h"
#include "analysis/report/machines/machines_results.h"

/* Campaign and results: struct wb_machines, struct wb_machines_results. */
extern const struct wb_kind wb_machines_kind;

#endif
