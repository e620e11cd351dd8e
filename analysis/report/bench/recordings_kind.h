/* The report of a campaign of recordings: wires that were tested, calibrated and validated. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_KIND_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_KIND_H

#include "analysis/keys/keys.h"
#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/kind.h"

/* Campaign and results: struct wb_recordings, struct wb_recordings_results. */
extern const struct wb_kind wb_recordings_kind;

/* Its parts, with the figures of recordings_figures.h. */
wb_kind_pages wb_recordings_pages_build;
wb_kind_json wb_recordings_json_build;

/* Keys of its report.json. */
extern const struct wb_keys wb_recordings_json_keys;

#endif
