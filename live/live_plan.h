/* Data of a test for its live views that are known before it begins: names, limits, and the curve
 * predicted from the wire's properties. */
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
    const char *title;     /* borrowed; names of rig and specimen */
    const char *recording; /* borrowed; its path, for the free space on its disk */
    bool is_virtual;
    double length;       /* m, of the wire */
    double travel;       /* m, of the stage in each cycle */
    double force_limit;  /* N, of the strand tension; 0: none */
    double travel_limit; /* m; 0: none */
    double gravity;      /* m/s2 */
    int n_predicted;     /* 0: the wire has no properties, or the beam did not converge */
    double deflection[WB_LIVE_PLAN_POINTS], tension[WB_LIVE_PLAN_POINTS]; /* m; N, of the strand */
    size_t n_earlier;                          /* points of earlier tests of the series; 0: none */
    const struct wb_live_frame_point *earlier; /* borrowed; `cycle` is the number of the test */
};

/* Fills the plan except title, recording and earlier tests. The prediction is one cycle of the
 * paper's test of a straight virgin wire, computed with the 1D beam (fe/trial/cantilever.h) with
 * strand and weights of the rig; if the beam does not converge, it ends early. A missing prediction
 * is not an error. */
WB_MUST_CHECK enum wb_status wb_live_plan_make(struct wb_live_plan *plan, const struct wb_rig *rig,
                                               const struct wb_specimen *specimen,
                                               const struct wb_wire *wire, double travel);

#endif
