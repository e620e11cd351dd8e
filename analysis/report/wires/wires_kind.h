/* The report of a comparison: a wire as a solid and as a rod. */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_KIND_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_KIND_H

#include "analysis/keys/keys.h"
#include "analysis/report/kind.h"
#include "analysis/report/wires/wires_results.h"

/* Campaign and results: struct wb_wires, struct wb_wires_results. */
extern const struct wb_kind wb_wires_kind;

/* --- its parts --- */

enum {
    WB_WIRES_FIGURES = 8
};

/* After the paper's Figs. 3, 4 and 5. Places: "elastic", "elastic-shapes", "elastoplastic",
 * "found" on the first page, "residual" of each case with residual stress, "residual-effect". */
extern const struct wb_figures_row wb_wires_figures[WB_WIRES_FIGURES];
wb_kind_pages wb_wires_pages_build;
wb_kind_json wb_wires_json_build;
extern const struct wb_keys wb_wires_json_keys; /* of its report.json */

/* The first page, without its figure. */
void wb_wires_found_put(struct wb_document *document, const struct wb_wires_results *results);

#endif
