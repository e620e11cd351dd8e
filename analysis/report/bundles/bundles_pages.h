/* What the report of bundles says. */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_PAGES_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_PAGES_H

#include "analysis/report/bundles/bundles_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

/* Builds the document; release it before the figures. */
void wb_bundles_pages_build(struct wb_document *document, const struct wb_bundles_results *results,
                            const struct wb_figures *figures);

#endif
