/* All numbers of a report as JSON, with units in the keys. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_JSON_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_JSON_H

#include "analysis/report/bench/recordings_results.h"
#include "base/json.h"

/* Builds the document (the caller destroys it); NULL when out of memory. `files` are the report's
 * own files, relative to its folder. */
struct wb_json *wb_recordings_json_build(const struct wb_recordings_results *results,
                                         const char *const *files, int n_files);

#endif
