/* Draws the curve and the wire of a live view as dots, and chooses the ranges of the axes. */
#ifndef WB_LIVE_LIVE_CHART_H
#define WB_LIVE_LIVE_CHART_H

#include <stdbool.h>

#include "analysis/plot/scale.h"
#include "live/live_history.h"
#include "live/live_plan.h"
#include "live/live_raster.h"

struct wb_live_chart {
    struct wb_scale deflection, force; /* mm; mN, strand tension */
    bool shows_force_limit;            /* the limit is within the range of the axis */
};

/* Chooses ranges for the curve, earlier tests, the prediction, the travel, and nearby limits. */
void wb_live_chart_range(struct wb_live_chart *chart, const struct wb_live_plan *plan,
                         const struct wb_live_history *history);

/* Draws limits, prediction, earlier tests and cycles, and the present cycle. */
void wb_live_chart_draw(const struct wb_live_chart *chart, const struct wb_live_plan *plan,
                        const struct wb_live_history *history, struct wb_live_raster *raster);

/* Draws the wire through its markers with equal scales in both directions; `place` receives the dot
 * of each marker. */
void wb_live_chart_wire(const struct wb_live_plan *plan, const struct wb_live_frame *frame,
                        struct wb_live_raster *raster, double place[WB_SPECIMEN_MAX_MARKERS][2]);

#endif
