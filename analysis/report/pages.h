/* What the report says, in order: summary, specimens and bench, all wires, each wire, provenance.
 */
#ifndef WB_ANALYSIS_REPORT_PAGES_H
#define WB_ANALYSIS_REPORT_PAGES_H

#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

/* Builds the document; release it before the figures. */
void wb_pages_build(struct wb_document *document, const struct wb_recordings_results *results,
                    const struct wb_figures *figures);

#endif
