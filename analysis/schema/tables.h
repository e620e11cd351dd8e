/* Tables that several files of this room use. */
#ifndef WB_ANALYSIS_SCHEMA_TABLES_H
#define WB_ANALYSIS_SCHEMA_TABLES_H

#include "analysis/keys/row.h"

/* Laws (law_keys.c). */
extern const struct wb_keys wb_schema_law_numbers; /* of a form, with _MPa */
extern const struct wb_keys wb_schema_law_of_file;
extern const struct wb_keys wb_schema_law_of_json;
extern const struct wb_keys wb_schema_ludwik; /* E, sigma_Y, K, n */

/* Of several files (common_keys.c). */
extern const struct wb_keys wb_schema_tool;
extern const struct wb_keys wb_schema_campaign;
extern const struct wb_keys wb_schema_excluded;
extern const struct wb_keys wb_schema_sum;
extern const struct wb_keys wb_schema_machine;

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
