/* Identifies the specimen's markers among the points of each motion-capture frame, by geometry.
 *
 * Ids are not used, because they change whenever a bare marker is found again. The markers are
 * identified by their order along the wire, the known arc lengths, and prediction from the previous
 * frames. The start is the best chain of points whose distances fit the arc lengths; from there the
 * markers are followed through the recording, forwards and backwards. Occluded and model-filled
 * points are not measurements and must not be passed. A marker that is not seen is missing: gaps
 * are not filled.
 */
#ifndef WB_ANALYSIS_ALIGN_MARKERS_H
#define WB_ANALYSIS_ALIGN_MARKERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"
#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* One frame of candidate points: `n` of them from `first` in the cloud's points. */
struct wb_point_frame {
    int64_t t_ns;    /* host arrival */
    double t_device; /* s, server's capture stamp; NaN unknown */
    double t_clock;  /* s, on the clock of the probes; NaN unknown */
    size_t first;
    int n;
};

/* All measured points of a recording. */
struct wb_point_cloud {
    size_t n_frames, n_points;
    struct wb_point_frame *frames; /* owned */
    double (*points)[3];           /* m, in the server's frame; owned */
    size_t frames_capacity, points_capacity;
    uint64_t n_occluded, n_filled; /* left out: occluded, model-filled */
};

/* Adds a frame, without its occluded and model-filled markers. */
void wb_point_cloud_add(struct wb_point_cloud *cloud, const struct wb_mocap_frame *frame);
void wb_point_cloud_release(struct wb_point_cloud *cloud);

struct wb_marker_settings {
    double noise;        /* m, expected standard deviation of a coordinate; 0 takes 0.1 mm */
    double frame_period; /* s between frames as the bench's clock counts; 0 takes 1/120 s */
};

/* The identified markers. */
struct wb_marker_tracks {
    const struct wb_point_cloud *cloud; /* in which they were found; must outlive this struct */
    int n_markers;
    size_t n_frames;
    /* (n_frames x n_markers) index into the cloud's points; -1: not seen in this frame */
    int32_t *index;     /* owned */
    size_t n_strays;    /* points that are not one of the markers, over all frames */
    size_t n_missing;   /* markers not seen, over all frames */
    size_t n_searches;  /* times the chain was searched for again */
    size_t start_frame; /* where the first chain was found */
    bool symmetric; /* distances are the same from both ends, so the order along the wire may have
                       to be reversed */
};

/* Identifies the specimen's markers in every frame. WB_ERR_DATA if no frame shows a chain of at
 * least all but two of them, including the first and the last. `why` receives the reason; with NULL
 * it is logged. */
WB_MUST_CHECK enum wb_status wb_markers_track(struct wb_marker_tracks *tracks,
                                              const struct wb_point_cloud *cloud,
                                              const struct wb_specimen *specimen,
                                              const struct wb_marker_settings *settings,
                                              struct wb_reason *why);
void wb_marker_tracks_release(struct wb_marker_tracks *tracks);

/* Reverses the order: the last marker becomes the first. */
void wb_markers_reverse(struct wb_marker_tracks *tracks);

/* Position of a marker in a frame, or NULL if it is not seen. */
const double *wb_markers_position(const struct wb_marker_tracks *tracks, size_t frame, int marker);

#endif
