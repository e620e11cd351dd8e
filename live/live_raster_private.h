/* For the test of live_raster.c. */
#ifndef WB_LIVE_LIVE_RASTER_PRIVATE_H
#define WB_LIVE_LIVE_RASTER_PRIVATE_H

#include "live/live_raster.h"

/* A dot; x from the left, y from the bottom. Outside of the drawing, or NaN: nothing. */
void wb_live_raster_dot(struct wb_live_raster *raster, double x, double y,
                        enum wb_live_raster_layer layer);

#endif
