/* Bands as files of a dataset's folder, as members of dataset.json, and as a text.
 *
 *     bands.csv   case,quantity,at,median,low,high,runs_low,runs_high
 *     cases.csv   a line for each case: what it is, force at the largest deflection, springback
 *     bands.svg   a panel for each quantity, with the first cases
 *
 * Columns and units are in docs/file-formats.md. */
#ifndef WB_ANALYSIS_PREDICT_BANDS_OUTPUT_H
#define WB_ANALYSIS_PREDICT_BANDS_OUTPUT_H

#include "analysis/keys/keys.h"
#include "analysis/plot/figure.h"
#include "analysis/predict/bands.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

/* Writes the files. With `bands` NULL, removes those of an earlier run. */
WB_MUST_CHECK enum wb_status wb_bands_output_write(const struct wb_bands *bands,
                                                   const char *folder);

enum {
    WB_BANDS_OUTPUT_PANELS = 2 /* force over deflection, moment over curvature */
};

/* Adds the two panels to a figure, with the first cases: medians as lines, and the bands that
 * include the model's error. */
void wb_bands_output_draw(const struct wb_bands *bands, struct wb_figure *figure,
                          struct wb_panel *panels[WB_BANDS_OUTPUT_PANELS]);

/* Keys of `uncertainty`. */
extern const struct wb_keys wb_bands_output_keys;

/* Sets the member `uncertainty` of an object. */
void wb_bands_output_describe(const struct wb_bands *bands, struct wb_json *object);

/* Appends tables for a terminal. */
void wb_bands_output_summarise(const struct wb_bands *bands, struct wb_text *text);

#endif
