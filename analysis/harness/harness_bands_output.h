/* Bands of a harness as a table, bands.csv of the folder of results, as the member `uncertainty` of
 * harness.json, and as a text. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_BANDS_OUTPUT_H
#define WB_ANALYSIS_HARNESS_HARNESS_BANDS_OUTPUT_H

#include "analysis/harness/harness_bands.h"
#include "analysis/keys/keys.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

extern const struct wb_keys wb_harness_bands_output_keys;

/* Sets the members of `uncertainty`. */
void wb_harness_bands_output_put(struct wb_json *object, const struct wb_harness_bands *bands);

/* Writes the table. With `bands` NULL, removes that of an earlier run. */
WB_MUST_CHECK enum wb_status wb_harness_bands_output_write(const struct wb_harness_bands *bands,
                                                           const char *folder);

/* Appends a table for a terminal. */
void wb_harness_bands_output_append_table(struct wb_text *text,
                                          const struct wb_harness_bands *bands);

/* Appends how many runs found no equilibrium or snapped otherwise, and the first of them; nothing
 * if there are none. */
void wb_harness_bands_output_append_deviants(struct wb_text *text,
                                             const struct wb_harness_bands *bands);

#endif
