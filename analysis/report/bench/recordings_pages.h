/* Parts of the pages of recordings: the first page; of calibrations on whole cycles the tables of
 * all wires, the chapter of each, and sentences that the first page has, too. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_PAGES_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_PAGES_H

#include "analysis/calibration/properties/quantity.h"
#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

/* The first page: of each wire what was calibrated and whether it predicts the other length, by
 * loading and unloading where the campaign calibrates on whole cycles, else by the paper's route.
 */
void wb_recordings_found_put(struct wb_document *document,
                             const struct wb_recordings_results *results,
                             const struct wb_figures *figures);

/* Appends "NAME = 35.2 N mm2 (31.0 to 40.1)", in the quantity's unit and with its interval. */
void wb_recordings_cycle_append(struct wb_text *text, const char *name, enum wb_quantity_id id,
                                const struct wb_estimate *estimate);

/* Appends unloading stiffness and residual curvature ratio between their ends over the laws. */
void wb_recordings_cycle_append_ranges(struct wb_text *text,
                                       const struct wb_cycle_calibration *calibration);

/* A row of a table that compares two validations: a number of each. */
struct wb_recordings_score {
    const char *name, *unit; /* markup */
    size_t offset;           /* of a double in struct wb_validate_result */
    double in_unit;          /* the unit in SI */
    int decimals;
    bool needs_scatter, needs_unloading; /* unknown without two samples, without unloading */
};
/* Adds the n rows, where a validation (NULL: there is none) has no such number with a dash. */
void wb_recordings_cycle_put_scores(struct wb_document_table *table,
                                    const struct wb_recordings_score *rows, size_t n,
                                    const struct wb_validate_result *const results[2]);
/* Adds one such row, of numbers in their unit. */
void wb_recordings_cycle_put_score(struct wb_document_table *table, const char *name,
                                   const char *unit, const double values[2], int decimals);

/* EI, M(kappa), residual curvature ratio and the verdict on the hardening rule of every wire;
 * nothing where the campaign does not calibrate on whole cycles. */
void wb_recordings_cycle_put_summary(struct wb_document *document,
                                     const struct wb_recordings_results *results);

/* The chapter of one wire, below its heading; nothing where there is no such calibration. */
void wb_recordings_cycle_put_wire(struct wb_document *document,
                                  const struct wb_recordings_results *results, int index,
                                  const struct wb_figures *figures);

#endif
