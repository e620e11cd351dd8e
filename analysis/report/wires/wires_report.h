/* The report of a comparison: report.pdf, report.html, report.json and figures/.
 *
 * The same datasets and the same revision give the same bytes: what a simulation cost is read from
 * its dataset, and nothing depends on the time or the place of the run.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_REPORT_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_REPORT_H

#include <stdbool.h>

#include "analysis/report/wires/wires_results.h"
#include "base/json.h"
#include "base/status.h"

/* Writes everything into `folder`, as wb_files_write() does. */
WB_MUST_CHECK enum wb_status wb_wires_report_write(const struct wb_wires_results *results,
                                                   const char *folder, bool force);

/* All numbers as one document; the report's files are listed in it. */
struct wb_json *wb_wires_json_build(const struct wb_wires_results *results,
                                    const char *const *files, int n_files);

#endif
