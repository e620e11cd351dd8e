/* Makes the frames of live views from a running test: sees its samples, and fills a frame when it
 * is asked. Used by the thread of the test. */
#ifndef WB_LIVE_LIVE_SOURCE_H
#define WB_LIVE_LIVE_SOURCE_H

#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "daq/test/bend_test.h"
#include "live/live_feed.h"
#include "live/live_shape.h"

struct wb_live_source {
    struct wb_live_feed *feed;       /* borrowed; points of the curve go there */
    const struct wb_bend_test *test; /* borrowed; NULL before it is open */
    struct wb_specimen specimen;
    char up;
    int64_t point_interval_ns, point_ns; /* least time between points, and of the last one */
    struct wb_live_shape shape;
};

/* Begins, before the test is opened; set `test` once it is. */
void wb_live_source_init(struct wb_live_source *source, struct wb_live_feed *feed,
                         const struct wb_rig *rig, const struct wb_specimen *specimen);

/* For the test's request: what sees its samples. `source` must outlive the test. */
struct wb_sink wb_live_source_sink(struct wb_live_source *source);

/* The present state, all of the frame but what wb_live_feed_push() fills in. */
void wb_live_source_fill(const struct wb_live_source *source, struct wb_live_frame *frame);

#endif
