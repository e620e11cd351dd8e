/* Tables that several files of this room use. */
#ifndef WB_ANALYSIS_SCHEMA_TABLES_H
#define WB_ANALYSIS_SCHEMA_TABLES_H

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"

/* Parts of dataset.json that reports copy (align_keys.c). */
extern const struct wb_keys wb_schema_correction;
extern const struct wb_keys wb_schema_checks;
extern const struct wb_keys wb_schema_aligned; /* keys of a dataset's root */

/* Simulations (simulation_keys.c), whole cycles (cycle_keys.c). */
extern const struct wb_keys wb_schema_simulation;
extern const struct wb_keys wb_schema_cycle;

/* Roots. */
extern const struct wb_keys wb_schema_dataset;
extern const struct wb_keys wb_schema_report;
extern const struct wb_keys wb_schema_manifest;
extern const struct wb_keys wb_schema_properties;

#endif
