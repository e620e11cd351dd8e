/* The report of taped bundles: explicit 3D runs, and the 1D beams fitted to them. */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_KIND_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_KIND_H

#include "analysis/keys/keys.h"
#include "analysis/report/bundles/bundles_results.h"
#include "analysis/report/kind.h"

/* Campaign and results: struct wb_bundles, struct wb_bundles_results. */
extern const struct wb_kind wb_bundles_kind;

/* --- its parts --- */

enum {
    WB_BUNDLES_FIGURE_ROWS = 9
};

/* After the paper's Figs. 17 to 26. Places: of each group "sections", "curves" and "energies", of
 * each pair of studies "studies", of each bundle "shapes", of each group "section-model",
 * "fit", and "found" on the first page. */
extern const struct wb_figures_row wb_bundles_figures[WB_BUNDLES_FIGURE_ROWS];
wb_kind_pages wb_bundles_pages_build;
wb_kind_json wb_bundles_json_build;
extern const struct wb_keys wb_bundles_json_keys; /* of its report.json */

/* The first page, without its figure. */
void wb_bundles_found_put(struct wb_document *document, const struct wb_bundles_results *results);

#endif
