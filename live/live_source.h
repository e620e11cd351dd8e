/* Makes the frames of live views from a running test: receives its samples, and fills a frame on
 * request. Used by the thread of the test. */
#ifndef WB_LIVE_LIVE_SOURCE_H
#define WB_LIVE_LIVE_SOURCE_H

#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "daq/test/bend_test.h"
#include "live/live_feed.h"
#include "live/live_shape.h"

struct wb_live_source {
    struct wb_live_feed *feed;       /* borrowed; receives the points of the curve */
    const struct wb_bend_test *test; /* borrowed; NULL until it is open */
    struct wb_specimen specimen;
    char up;
    int64_t point_interval_ns, point_ns; /* least time between points; time of the last one */
    struct wb_live_shape shape;
};

/* Initialises before the test is opened; set `test` once it is open. */
void wb_live_source_init(struct wb_live_source *source, struct wb_live_feed *feed,
                         const struct wb_rig *rig, const struct wb_specimen *specimen);

/* The sink for the test's request. `source` must outlive the test. */
struct wb_sink wb_live_source_sink(struct wb_live_source *source);

/* Fills the frame with the present state, except the members that wb_live_feed_push() sets. */
void wb_live_source_fill(const struct wb_live_source *source, struct wb_live_frame *frame);

#endif
