/* The first page of a report of testing machines, without its figure. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_FOUND_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_FOUND_H

#include "analysis/report/document.h"
#include "analysis/report/machines/machines_results.h"

void wb_machines_found_put(struct wb_document *document, const struct wb_machines_results *results);

#endif
