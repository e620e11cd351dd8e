/* Tables that several files of this room use. */
#ifndef WB_ANALYSIS_SCHEMA_TABLES_H
#define WB_ANALYSIS_SCHEMA_TABLES_H

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"

/* Simulations (schema_simulation.c). */
extern const struct wb_keys wb_schema_simulation;

/* Roots. */
extern const struct wb_keys wb_schema_dataset;
extern const struct wb_keys wb_schema_report;
extern const struct wb_keys wb_schema_manifest_keys;
extern const struct wb_keys wb_schema_properties_keys;

#endif
