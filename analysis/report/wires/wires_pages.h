/* What the report of a comparison says: summary, linear elastic, elastoplastic, residual stresses,
 * cost, provenance.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_PAGES_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_PAGES_H

#include "analysis/report/document.h"
#include "analysis/report/wires/wires_figures.h"
#include "analysis/report/wires/wires_results.h"

/* Builds the document; release it before the figures. */
void wb_wires_pages_build(struct wb_document *document, const struct wb_wires_results *results,
                          const struct wb_wires_figures *figures);

/* Its parts, in order; each adds its headings. */
void wb_wires_pages_summary(struct wb_document *document, const struct wb_wires_results *results);
void wb_wires_pages_elastic(struct wb_document *document, const struct wb_wires_results *results,
                            const struct wb_wires_figures *figures);
void wb_wires_pages_elastoplastic(struct wb_document *document,
                                  const struct wb_wires_results *results,
                                  const struct wb_wires_figures *figures);
void wb_wires_pages_residual(struct wb_document *document, const struct wb_wires_results *results,
                             const struct wb_wires_figures *figures);
void wb_wires_pages_cost(struct wb_document *document, const struct wb_wires_results *results);
void wb_wires_pages_provenance(struct wb_document *document,
                               const struct wb_wires_results *results);

/* What they share: the follower force at the end, N; a table of tips (`caption` NULL: a usual one),
 * and a row of it, with distances from the solid. Runs that are NULL are left out. */
double wb_wires_pages_force(const struct wb_wires_results *results);
/* " (the paper's Fig. N)", or "" of a campaign that has nothing of the paper's. */
const char *wb_wires_pages_figure(char text[48], const struct wb_wires_results *results,
                                  const char *number);
struct wb_document_table *wb_wires_pages_start_tips(struct wb_document *document,
                                                    const char *caption);
void wb_wires_pages_put_tip(struct wb_document *document, struct wb_document_table *table,
                            const char *label, const struct wb_wires_run *run,
                            const struct wb_wires_run *solid);

#endif
