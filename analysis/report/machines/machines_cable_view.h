/* A cable and its layers in a report: figures, a chapter, numbers. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_CABLE_VIEW_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_CABLE_VIEW_H

#include <stdio.h>

#include "analysis/report/document.h"
#include "analysis/report/figures.h"
#include "analysis/report/machines/machines_results.h"
#include "base/json.h"

/* As of struct wb_figures_row: a figure of each layered group. */
int wb_machines_cable_count(const void *results);
enum wb_status wb_machines_cable_draw(struct wb_figures_item *item);

/* Nothing where the campaign has no cable. */
void wb_machines_cable_put(struct wb_document *document, const struct wb_machines_results *results,
                           const struct wb_figures *drawn);
void wb_machines_cable_put_json(struct wb_json *root, const struct wb_machines_results *results);
void wb_machines_cable_print(FILE *out, const struct wb_machines_results *results);

#endif
