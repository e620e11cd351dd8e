/* Results of a harness as files: harness.json with everything but the shapes, shapes.csv with the
 * places along the branches after each step, forces.csv with what holds the items. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_OUTPUT_H
#define WB_ANALYSIS_HARNESS_HARNESS_OUTPUT_H

#include <stddef.h>

#include "analysis/harness/harness_bands.h"
#include "analysis/harness/harness_run.h"
#include "analysis/keys/keys.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

/* Keys of harness.json, those that describe a result, which reports have, too, and those of a step.
 */
extern const struct wb_keys wb_harness_output_keys, wb_harness_output_result_keys,
    wb_harness_output_step_keys;

/* Values of a place of a shape, in the units of its keys. */
enum {
    WB_HARNESS_OUTPUT_COLUMNS = 12,
    WB_HARNESS_OUTPUT_POSITION = 4 /* the first ones: place along the branch, position */
};
extern const struct wb_harness_output_column {
    const char *key;
    size_t offset; /* in struct wb_harness_place */
    int shift;     /* decimal digits from SI units to those of the key */
} wb_harness_output_columns[WB_HARNESS_OUTPUT_COLUMNS];

/* The value in SI units. */
double wb_harness_output_value(const struct wb_harness_place *place,
                               const struct wb_harness_output_column *column);

/* Members of harness.json into an object; the same without program and kind of file. `bands` may be
 * NULL, here and below. */
void wb_harness_output_put(struct wb_json *object, const struct wb_harness_result_set *set,
                           const struct wb_harness_bands *bands);
void wb_harness_output_put_result(struct wb_json *object, const struct wb_harness_result_set *set,
                                  const struct wb_harness_bands *bands);

/* The same of one step: a member of its `steps`. */
void wb_harness_output_put_step(struct wb_json *object, const struct wb_harness_plan *plan,
                                const char *name, const struct wb_harness_step_result *step);

/* Writes the files into a folder, which exists. */
WB_MUST_CHECK enum wb_status wb_harness_output_write(const struct wb_harness_result_set *set,
                                                     const struct wb_harness_bands *bands,
                                                     const char *folder);

/* A table for a terminal: each step with its forces and least radius. */
void wb_harness_output_append_table(struct wb_text *text, const struct wb_harness_result_set *set);

/* One sentence: residual shape or largest force, and limits that are exceeded. */
void wb_harness_output_append_finding(struct wb_text *text,
                                      const struct wb_harness_result_set *set);

#endif
