/* A drawing of a harness in three views: the stress-free shape, the shape as mounted, and the one
 * that remains after it was taken off. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_DRAWING_H
#define WB_ANALYSIS_HARNESS_HARNESS_DRAWING_H

#include "analysis/harness/harness_run.h"
#include "base/status.h"

/* Writes an SVG, PNG or PDF by the ending of its name; an existing file is replaced. */
WB_MUST_CHECK enum wb_status wb_harness_drawing_write(const struct wb_harness_result_set *set,
                                                      const char *path);

#endif
