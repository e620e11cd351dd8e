/* Between the tables of report.json: what all kinds share, and the kinds. Of this room only. */
#ifndef WB_ANALYSIS_SCHEMA_REPORT_KEYS_H
#define WB_ANALYSIS_SCHEMA_REPORT_KEYS_H

#include "analysis/report/numbers.h"
#include "analysis/report/simulation.h"
#include "analysis/schema/tables.h"

extern const struct wb_keys wb_schema_report_comparison;
extern const struct wb_keys wb_schema_report_bundles;
extern const struct wb_keys wb_schema_report_prediction;
extern const struct wb_keys wb_machines_kind_keys;

#endif
