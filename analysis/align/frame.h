/* The clamp's frame: conversion from the motion-capture server's coordinates to the bench's.
 *
 * The clamp moves straight down and up, and its motion gives the vertical. The wire bends in a
 * plane that contains the vertical; the plane's horizontal direction is x, along the straight wire.
 * The origin is the clamp point: it moves with the clamp's marker, which is one marker offset above
 * it.
 */
#ifndef WB_ANALYSIS_ALIGN_FRAME_H
#define WB_ANALYSIS_ALIGN_FRAME_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/align/markers.h"
#include "base/reason.h"

struct wb_bench_frame {
    double up[3], along[3], normal[3]; /* unit vectors y, x and x cross y, in server coordinates */
    bool up_from_motion;   /* else the clamp hardly moved and up is the server's up axis */
    double up_uncertainty; /* rad, standard error of up's direction in the bending plane */
    double motion;         /* m, range of the clamp marker along up */
    double tilt;           /* rad, angle between up and the server's up axis */
    double straightness;   /* m, RMS distance of the clamp marker's path from a straight line */
    double planarity;      /* m, RMS distance of the markers from the bending plane */
    double plane_tilt;     /* rad, angle of the freely fitted plane's normal to the horizontal;
                              0 where the wire did not bend enough for one */
    /* (frames of the tracks x 3) clamp marker, smoothed over time, in server coordinates; NaN in
     * frames too far from one in which it was seen. Owned. */
    double (*clamp)[3];
};

/* True if the last marker moved along `server_up` (unit vector) more than the first: the order is
 * then reversed, since the clamp moves and the tip is held by the strand. False also if neither
 * moved 5 mm, which leaves the order undetermined. */
bool wb_frame_is_reversed(const struct wb_marker_tracks *tracks, const double server_up[3]);

/* Fits the frame. `times` (s, ascending, one per frame) are used to smooth the clamp's path over
 * +-`window` seconds. WB_ERR_DATA if the markers and the vertical span no plane. `why` receives the
 * reason; with NULL it is logged. */
WB_MUST_CHECK enum wb_status wb_frame_fit(struct wb_bench_frame *frame,
                                          const struct wb_marker_tracks *tracks,
                                          const double *times, double window,
                                          const double server_up[3], struct wb_reason *why);
void wb_frame_release(struct wb_bench_frame *frame);

/* Coordinates x, y (and z out of the plane; may be NULL) of a server point relative to the clamp's
 * marker in a frame. NaN if the clamp's position is unknown there. */
void wb_frame_coordinates(const struct wb_bench_frame *frame, size_t index, const double point[3],
                          double *x, double *y, double *z);

/* Height of the clamp's marker along up, m; falls as the stage travels down. */
double wb_frame_clamp_height(const struct wb_bench_frame *frame, size_t index);

#endif
