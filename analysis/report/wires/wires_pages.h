/* What the report of wires says. */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_PAGES_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_PAGES_H

#include "analysis/report/document.h"
#include "analysis/report/figures.h"
#include "analysis/report/wires/wires_results.h"

/* Builds the document; release it before the figures. */
void wb_wires_pages_build(struct wb_document *document, const struct wb_wires_results *results,
                          const struct wb_figures *figures);

#endif
