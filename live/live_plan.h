/* What is known of a test before it begins, for its live views: names, limits, and the curve that
 * the wire's properties predict. */
#ifndef WB_LIVE_LIVE_PLAN_H
#define WB_LIVE_LIVE_PLAN_H

#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "fe/model/wire.h"
#include "live/live_frame.h"

#define WB_LIVE_PLAN_STEPS 60 /* of the predicted loading */
#define WB_LIVE_PLAN_POINTS (2 * WB_LIVE_PLAN_STEPS + 1)

struct wb_live_plan {
    const char *title;     /* borrowed: of the rig file and the specimen, for people */
    const char *recording; /* borrowed: its path, for the room on its disk */
    bool is_virtual;
    double length;       /* m, of the wire */
    double travel;       /* m, of the stage in each cycle */
    double force_limit;  /* N; 0: none */
    double travel_limit; /* m; 0: none */
    double gravity;      /* m/s2 */
    int n_predicted;     /* 0: the wire has no properties, or the beam did not converge */
    double deflection[WB_LIVE_PLAN_POINTS], tension[WB_LIVE_PLAN_POINTS]; /* m, N */
    size_t n_earlier; /* points of the earlier tests of the series; 0: there are none */
    const struct wb_live_frame_point *earlier; /* borrowed; `cycle` is the number of the test */
};

/* Fills the plan but title, recording and earlier tests. The prediction is one cycle of the paper's
 * test with the 1D beam (fe/trial/cantilever.h) on the rig's strand, weights included, of a
 * straight virgin wire; where the beam does not reach the turn, as far as it comes. Not to have a
 * prediction is no error. */
WB_MUST_CHECK enum wb_status wb_live_plan_make(struct wb_live_plan *plan, const struct wb_rig *rig,
                                               const struct wb_specimen *specimen,
                                               const struct wb_wire *wire, double travel);

#endif
