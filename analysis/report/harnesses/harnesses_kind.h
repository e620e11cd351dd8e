/* A report of a harness as a kind of report (analysis/report/kind.h). */
#ifndef WB_ANALYSIS_REPORT_HARNESSES_HARNESSES_KIND_H
#define WB_ANALYSIS_REPORT_HARNESSES_HARNESSES_KIND_H

#include "analysis/keys/keys.h"
#include "analysis/report/found.h"
#include "analysis/report/harnesses/harnesses.h"

/* Campaign and results: struct wb_harnesses, struct wb_harnesses_results. */
extern const struct wb_kind wb_harnesses_kind;

/* Keys of its report.json. */
extern const struct wb_keys wb_harnesses_kind_keys;

/* Its figures, pages and first page, in files of their own. */
enum {
    WB_HARNESSES_FIGURES = 8
};
extern const struct wb_figures_row wb_harnesses_figures[WB_HARNESSES_FIGURES];
wb_kind_pages wb_harnesses_pages;
void wb_harnesses_found_put(struct wb_document *document,
                            const struct wb_harnesses_results *results);

#endif
