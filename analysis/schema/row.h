/* What the tables of keys share: the bits of a row's type, and tables that several files use.
 * Of this room only. */
#ifndef WB_ANALYSIS_SCHEMA_ROW_H
#define WB_ANALYSIS_SCHEMA_ROW_H

#include "analysis/schema/schema.h"
#include "base/config.h"

enum {
    TEXT = 1,
    NUMBER = 2,
    INTEGER = 4,
    FLAG = 8,
    OBJECT = 16,
    LIST = 32,      /* of the type beside it */
    UNKNOWN = 64,   /* null where the value is not known; of a list: an item may be null */
    OPTIONAL = 128, /* the key may be absent */
    BAND = 256,     /* a number, or a list of the least and the largest one */
    ESTIMATES = 512 /* of quantities: unknown numbers are null and not absent */
};

#define ROWS(table) (table), WB_COUNT(table)

/* Laws (law_keys.c). */
extern const struct wb_schema_object wb_schema_law_numbers; /* of a form, with _MPa */
extern const struct wb_schema_object wb_schema_law_of_file;
extern const struct wb_schema_object wb_schema_law_of_json;
extern const struct wb_schema_object wb_schema_ludwik; /* E, sigma_Y, K, n */

/* Of several files (common_keys.c). */
extern const struct wb_schema_object wb_schema_tool;
extern const struct wb_schema_object wb_schema_campaign;
extern const struct wb_schema_object wb_schema_excluded;
extern const struct wb_schema_object wb_schema_sum;
extern const struct wb_schema_object wb_schema_machine;
extern const struct wb_schema_object wb_schema_uncertainty;

/* Parts of dataset.json that reports copy (align_keys.c). */
extern const struct wb_schema_object wb_schema_correction;
extern const struct wb_schema_object wb_schema_checks;
extern const struct wb_schema_object wb_schema_aligned; /* keys of a dataset's root */

/* Simulations (simulation_keys.c), whole cycles (cycle_keys.c). */
extern const struct wb_schema_object wb_schema_simulation;
extern const struct wb_schema_object wb_schema_cycle;

/* Roots. */
extern const struct wb_schema_object wb_schema_dataset;
extern const struct wb_schema_object wb_schema_report;
extern const struct wb_schema_object wb_schema_manifest;
extern const struct wb_schema_object wb_schema_properties;

#endif
