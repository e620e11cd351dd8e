#include "live/live_shape.h"

#include <math.h>

#include "base/units.h"
#include "base/vec3.h"
#include "daq/acquire/marker_check.h"

/* Frames between two searches for all markers, which are slow; tracking is fast. */
#define LOOK_EVERY 12
/* The end that has moved down relative to the other by this much is the clamp. */
#define CLAMP_SINKS (1.0 * WB_MM)

static void find(struct wb_live_shape *shape, const struct wb_mocap_frame *frame,
                 const struct wb_specimen *specimen, char up)
{
    struct wb_marker_places places;
    if (shape->frames_looked++ % LOOK_EVERY != 0)
        return;
    wb_marker_check_frame(frame, specimen, &places);
    if (places.n_seen < specimen->n_markers)
        return;
    shape->n = specimen->n_markers;
    shape->up = up == 'z' ? 2 : 1;
    for (int i = 0; i < shape->n; i++)
        for (int k = 0; k < 3; k++)
            shape->at[i][k] = (double)frame->markers[places.index[i]].position[k];
    const double *const first = shape->at[0], *const last = shape->at[shape->n - 1];
    for (int k = 0; k < 3; k++)
        shape->along[k] = k == shape->up ? 0.0 : last[k] - first[k];
    shape->rest[0] = first[shape->up];
    shape->rest[1] = last[shape->up];
    shape->seen = (uint32_t)((UINT64_C(1) << shape->n) - 1);
    shape->is_found = wb_vec3_normalise(shape->along) > 0.0;
}

/* Moves a hidden marker like its nearest visible neighbours, so that it is found again. */
static void carry_hidden(struct wb_live_shape *shape, double moved[WB_SPECIMEN_MAX_MARKERS][3])
{
    for (int i = 0; i < shape->n; i++) {
        int n = 0, before = i - 1, after = i + 1;
        if (shape->seen & (1u << i))
            continue;
        while (before >= 0 && !(shape->seen & (1u << before)))
            before--;
        while (after < shape->n && !(shape->seen & (1u << after)))
            after++;
        n = (before >= 0) + (after < shape->n);
        for (int k = 0; n > 0 && k < 3; k++)
            shape->at[i][k] += ((before >= 0 ? moved[before][k] : 0.0) +
                                (after < shape->n ? moved[after][k] : 0.0)) /
                               n;
    }
}

static void find_clamp(struct wb_live_shape *shape)
{
    const double first = shape->at[0][shape->up] - shape->rest[0];
    const double last = shape->at[shape->n - 1][shape->up] - shape->rest[1];
    if (shape->is_clamp_known || fabs(first - last) < CLAMP_SINKS)
        return;
    shape->clamp = first < last ? 0 : shape->n - 1;
    shape->is_clamp_known = true;
}

void wb_live_shape_follow(struct wb_live_shape *shape, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen, char up)
{
    double moved[WB_SPECIMEN_MAX_MARKERS][3] = {{0}};
    if (!shape->is_found) {
        find(shape, frame, specimen, up);
        return;
    }
    shape->seen = 0;
    for (int i = 0; i < shape->n; i++) {
        const int found = wb_marker_check_nearest(frame, shape->at[i], WB_MARKER_CHECK_REACH);
        if (found < 0)
            continue;
        shape->seen |= 1u << i;
        for (int k = 0; k < 3; k++) {
            moved[i][k] = (double)frame->markers[found].position[k] - shape->at[i][k];
            shape->at[i][k] += moved[i][k];
        }
    }
    carry_hidden(shape, moved);
    find_clamp(shape);
}

/* Index of the i-th marker counted from the clamp. */
static int from_clamp(const struct wb_live_shape *shape, int i)
{
    return shape->clamp == 0 ? i : shape->n - 1 - i;
}

void wb_live_shape_place(const struct wb_live_shape *shape, int i, float place[2])
{
    const double *const at = shape->at[from_clamp(shape, i)];
    const double *const clamp = shape->at[shape->clamp];
    const double sign = shape->clamp == 0 ? 1.0 : -1.0;
    double along = 0.0;
    for (int k = 0; k < 3; k++)
        along += sign * shape->along[k] * (at[k] - clamp[k]);
    place[0] = (float)along;
    place[1] = (float)(at[shape->up] - clamp[shape->up]);
}

uint32_t wb_live_shape_seen(const struct wb_live_shape *shape)
{
    uint32_t seen = 0;
    for (int i = 0; i < shape->n; i++)
        seen |= (shape->seen >> from_clamp(shape, i) & 1u) << i;
    return seen;
}
