/* The report of a campaign of testing machines. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_KIND_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_KIND_H

#include "analysis/keys/keys.h"
#include "analysis/report/kind.h"
#include "analysis/report/machines/machines_results.h"

/* Campaign and results: struct wb_machines, struct wb_machines_results. */
extern const struct wb_kind wb_machines_kind;

/* Keys of its report.json. */
extern const struct wb_keys wb_machines_kind_keys;

/* --- its parts --- */

/* The first page, without its figure. */
void wb_machines_found_put(struct wb_document *document, const struct wb_machines_results *results);

/* A cable and its layers: a figure of each layered group as of struct wb_figures_row, a chapter,
 * numbers; nothing where the campaign has no cable. */
int wb_machines_cable_count(const void *results);
enum wb_status wb_machines_cable_draw(struct wb_figures_item *item);
void wb_machines_cable_put(struct wb_document *document, const struct wb_machines_results *results,
                           const struct wb_figures *drawn);
extern const struct wb_keys wb_machines_cable_keys; /* of `cable` in report.json */
void wb_machines_cable_put_json(struct wb_json *root, const struct wb_machines_results *results);
void wb_machines_cable_print(FILE *out, const struct wb_machines_results *results);

/* The same of the calibrated wires and the tests left out, a figure of each wire; nothing where the
 * campaign does not calibrate. */
int wb_machines_fits_count(const void *results);
enum wb_status wb_machines_fits_draw(struct wb_figures_item *item);
void wb_machines_fits_put(struct wb_document *document, const struct wb_machines_results *results,
                          const struct wb_figures *drawn);
extern const struct wb_keys wb_machines_fits_keys; /* of a wire in report.json */
void wb_machines_fits_put_json(struct wb_json *root, const struct wb_machines_results *results);

#endif
