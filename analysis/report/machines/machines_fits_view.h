/* Calibrated wires and tests left out in a report: figures, a chapter, numbers. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_FITS_VIEW_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_FITS_VIEW_H

#include "analysis/report/document.h"
#include "analysis/report/figures.h"
#include "analysis/report/machines/machines_results.h"
#include "base/json.h"

/* As of struct wb_figures_row: a figure of each wire. */
int wb_machines_fits_count(const void *results);
enum wb_status wb_machines_fits_draw(struct wb_figures_item *item);

/* Whether the law of a wire differs from the tests left out by more than 0.7 of their standard
 * deviation. */
bool wb_machines_fits_is_biased(const struct wb_machines_fit *fit);

/* These do nothing if the campaign does not calibrate. */
void wb_machines_fits_put(struct wb_document *document, const struct wb_machines_results *results,
                          const struct wb_figures *drawn);
void wb_machines_fits_put_json(struct wb_json *root, const struct wb_machines_results *results);

#endif
