/* Functions of live/live_raster.h that only tests call. */
#ifndef WB_LIVE_LIVE_RASTER_PRIVATE_H
#define WB_LIVE_LIVE_RASTER_PRIVATE_H

#include "live/live_raster.h"

/* Sets a dot; x from the left, y from the bottom. Ignored if outside the drawing or NaN. */
void wb_live_raster_dot(struct wb_live_raster *raster, double x, double y,
                        enum wb_live_raster_layer layer);

#endif
