/* Pages that reports of simulations have in common: datasets that are missing, and how to compute
 * them; decisions on limits; checksums.
 */
#ifndef WB_ANALYSIS_REPORT_SIMULATION_PAGES_H
#define WB_ANALYSIS_REPORT_SIMULATION_PAGES_H

#include "analysis/report/campaign.h"
#include "analysis/report/document.h"
#include "analysis/report/found.h"
#include "analysis/report/kind.h"
#include "analysis/report/simulation.h"
#include "analysis/report/verdict.h"

/* Starts the document of a report of simulations. */
void wb_simulation_pages_start(struct wb_document *document, const struct wb_kind_outcome *outcome);

/* Says on the first page that datasets are missing, and how to compute them. */
void wb_simulation_pages_add_missing(struct wb_found *found, const struct wb_kind_outcome *outcome);
/* Which datasets cannot be used, why, and how to compute each; nothing where all are used. */
void wb_simulation_pages_put_missing(struct wb_document *document,
                                     const struct wb_kind_outcome *outcome,
                                     wb_simulation_list *list, const void *results);

/* The verdicts of a laboratory's report with the decision rule; nothing in other reports. */
void wb_simulation_pages_put_decisions(struct wb_document *document,
                                       const struct wb_campaign *campaign,
                                       const struct wb_verdict *verdicts, int n);

/* A table of all datasets with their checksums, under a heading. */
void wb_simulation_pages_put_datasets(struct wb_document *document, wb_simulation_list *list,
                                      const void *results);

#endif
