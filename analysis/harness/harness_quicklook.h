/* A harness file at a glance: its stress-free shape as a drawing, and a summary. No step is
 * computed. Called by `wirebench quicklook`. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_QUICKLOOK_H
#define WB_ANALYSIS_HARNESS_HARNESS_QUICKLOOK_H

#include "analysis/harness/harness_run.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

/* Computes the stress-free shape. The results borrow the plan; release them with
 * wb_harness_run_release(). */
WB_MUST_CHECK enum wb_status wb_harness_quicklook_compute(struct wb_harness_result_set *set,
                                                          struct wb_harness_plan *plan);

/* Appends the summary: size and weight, wires, branches, items and steps. */
void wb_harness_quicklook_summary(const struct wb_harness_result_set *set, struct wb_text *text);

/* Sets the same in an object, with units in the keys. */
void wb_harness_quicklook_describe(const struct wb_harness_result_set *set, struct wb_json *object);

/* Writes shape.svg, .png and .pdf and summary.txt. WB_ERR_EXISTS when the folder already holds
 * anything, unless `force`. */
WB_MUST_CHECK enum wb_status wb_harness_quicklook_write(const struct wb_harness_result_set *set,
                                                        const char *folder, bool force);

#endif
