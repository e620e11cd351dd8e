/* What the report of bundles says: summary, bundles, studies, friction, 1D properties, cost, runs,
 * provenance.
 */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_PAGES_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_PAGES_H

#include "analysis/report/bundles/bundles_figures.h"
#include "analysis/report/bundles/bundles_results.h"
#include "analysis/report/document.h"

/* Builds the document; release it before the figures. */
void wb_bundles_pages_build(struct wb_document *document, const struct wb_bundles_results *results,
                            const struct wb_bundles_figures *figures);

/* Its parts, in order; each adds its headings. */
void wb_bundles_pages_summary(struct wb_document *document,
                              const struct wb_bundles_results *results);
void wb_bundles_pages_sections(struct wb_document *document,
                               const struct wb_bundles_results *results,
                               const struct wb_bundles_figures *figures);
void wb_bundles_pages_studies(struct wb_document *document,
                              const struct wb_bundles_results *results,
                              const struct wb_bundles_figures *figures);
void wb_bundles_pages_groups(struct wb_document *document, const struct wb_bundles_results *results,
                             const struct wb_bundles_figures *figures);
void wb_bundles_pages_fit(struct wb_document *document, const struct wb_bundles_results *results,
                          const struct wb_bundles_figures *figures);
void wb_bundles_pages_cost(struct wb_document *document, const struct wb_bundles_results *results);
void wb_bundles_pages_runs(struct wb_document *document, const struct wb_bundles_results *results);
void wb_bundles_pages_provenance(struct wb_document *document,
                                 const struct wb_bundles_results *results);

/* What they share: "dead force", "strand, weight"; " (the paper's Fig. N)", or "" without a number.
 */
const char *wb_bundles_pages_loading(const struct wb_bundles_run *run);
const char *wb_bundles_pages_figure(char text[48], const char *number);
/* A table of the runs given by index, with RMS, force and energies of each; `explained`: its
 * caption tells what the columns are. */
void wb_bundles_pages_put_runs(struct wb_document *document,
                               const struct wb_bundles_results *results, int n, const int *runs,
                               bool explained);

#endif
