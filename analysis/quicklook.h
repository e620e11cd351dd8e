/* One dataset at a glance: a text summary and figures of the force-deflection curve and of the
 * shapes. For the operator at the bench; a report covers a campaign of many tests. */
#ifndef WB_ANALYSIS_QUICKLOOK_H
#define WB_ANALYSIS_QUICKLOOK_H

#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

/* Appends the summary: what was tested, how far, stiffness, corrections and warnings. */
void wb_quicklook_summary(const struct wb_dataset *dataset, struct wb_text *text);

/* Sets the same in an object, with units in the keys. */
void wb_quicklook_describe(const struct wb_dataset *dataset, struct wb_json *object);

/* Writes the curve alone, as an SVG, PNG or PDF by the ending of its name; its footer says where
 * the data come from. An existing file is replaced. */
WB_MUST_CHECK enum wb_status wb_quicklook_draw(const struct wb_dataset *dataset, const char *path);

/* Writes the dataset's files and beside them force_deflection.svg, .png and .pdf, shapes.svg and
 * .png (where there are shapes), and summary.txt. WB_ERR_EXISTS when the folder already holds
 * anything, unless `force`. */
WB_MUST_CHECK enum wb_status wb_quicklook_write(const struct wb_dataset *dataset,
                                                const char *folder, bool force);

#endif
