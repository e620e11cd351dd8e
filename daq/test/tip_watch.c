#include "daq/test/tip_watch.h"

#include <math.h>

#include "base/units.h"
#include "base/vec3.h"
#include "daq/acquire/marker_check.h"

#define SMOOTHING 0.1 /* weight of a new frame in the exponential average */

/* Finds both ends near their last positions; false if one is hidden (its position is kept). */
static bool follow_ends(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame)
{
    bool both = true;
    for (int end = 0; end < 2; end++) {
        double *const at = watch->at[end];
        const int found = wb_marker_check_nearest(frame, at, WB_MARKER_CHECK_REACH);
        both = both && found >= 0;
        if (found >= 0)
            watch->seen_ns[end] = frame->t_ns;
        for (int k = 0; found >= 0 && k < 3; k++)
            at[k] = (double)frame->markers[found].position[k];
    }
    return both;
}

void wb_tip_watch_rest(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame,
                       const struct wb_specimen *specimen, char up)
{
    if (watch->found) {
        if (follow_ends(watch, frame)) {
            for (int end = 0; end < 2; end++)
                for (int k = 0; k < 3; k++)
                    wb_average_add(&watch->rest[end][k], watch->at[end][k]);
            watch->settled = true;
        }
        return;
    }
    struct wb_marker_places places;
    wb_marker_check_frame(frame, specimen, &places);
    const int ends[2] = {places.index[0], places.index[specimen->n_markers - 1]};
    if (ends[0] < 0 || ends[1] < 0)
        return;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            watch->at[end][k] = (double)frame->markers[ends[end]].position[k];
    watch->up = up == 'z' ? 2 : 1;
    watch->found = true;
}

void wb_tip_watch_follow(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame)
{
    if (!watch->settled || !follow_ends(watch, frame))
        return;
    /* The absolute value makes it irrelevant which end is the tip. */
    const int up = watch->up;
    const double now = fabs((watch->at[1][up] - watch->rest[1][up].mean) -
                            (watch->at[0][up] - watch->rest[0][up].mean));
    watch->deflection += SMOOTHING * (now - watch->deflection);
}

double wb_tip_watch_moved(const struct wb_tip_watch *watch, int end)
{
    double way[3];
    for (int k = 0; k < 3; k++)
        way[k] = watch->at[end][k] - watch->rest[end][k].mean;
    return sqrt(wb_vec3_dot(way, way));
}

int wb_tip_watch_clamp(const struct wb_tip_watch *watch)
{
    return wb_tip_watch_moved(watch, 1) > wb_tip_watch_moved(watch, 0);
}
