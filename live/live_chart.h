/* The curve and the wire of a live view as dots: ranges of the axes, and what is drawn where. */
#ifndef WB_LIVE_LIVE_CHART_H
#define WB_LIVE_LIVE_CHART_H

#include <stdbool.h>

#include "analysis/plot/scale.h"
#include "live/live_history.h"
#include "live/live_plan.h"
#include "live/live_raster.h"

struct wb_live_chart {
    struct wb_scale deflection, force; /* in mm and mN */
    bool shows_force_limit;            /* it is near enough to be within the axis */
};

/* Ranges that hold the curve, those of earlier tests, the prediction, the way of the stage, and the
 * limits as far as they are near. */
void wb_live_chart_range(struct wb_live_chart *chart, const struct wb_live_plan *plan,
                         const struct wb_live_history *history);

/* Draws limits, prediction, earlier tests and cycles, and this cycle. */
void wb_live_chart_draw(const struct wb_live_chart *chart, const struct wb_live_plan *plan,
                        const struct wb_live_history *history, struct wb_live_raster *raster);

/* Draws the wire through its markers at one scale for both directions; `place` receives each
 * marker's dot. */
void wb_live_chart_wire(const struct wb_live_plan *plan, const struct wb_live_frame *frame,
                        struct wb_live_raster *raster, double place[WB_SPECIMEN_MAX_MARKERS][2]);

#endif
