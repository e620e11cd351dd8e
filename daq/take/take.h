/* A take of motion capture, read from a CSV file of Motive, a C3D or a TRC file.
 *
 * Points are stored sparsely: a file of unlabelled markers has a new point each time the cameras
 * find a marker again, and a frame shows few of them. Geometry decides which points are the same
 * marker (analysis/align/markers.h). A point that is not seen in a frame is missing there; nothing
 * is filled in.
 *
 * A reader rejects a file that it cannot read completely, with file, line and column (binary files:
 * offset or parameter); skipped rows are counted in the take.
 */
#ifndef WB_DAQ_TAKE_TAKE_H
#define WB_DAQ_TAKE_TAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"
#include "daq/protocol/cells.h"
#include "daq/protocol/sample.h"

enum wb_take_kind {
    WB_TAKE_MARKER,     /* measured, with a name */
    WB_TAKE_UNLABELLED, /* measured; a new point each time it is found again */
    WB_TAKE_SOLVED,     /* computed from a rigid body, also while the marker is lost */
    WB_TAKE_BODY        /* the origin of a rigid body or bone */
};

#define WB_TAKE_LARGEST_POSITION 1e4 /* m, that a reader accepts */

struct wb_take_point {
    char name[64]; /* truncated, printable ASCII */
    enum wb_take_kind kind;
    size_t n_seen; /* number of frames that contain it */
};

/* Position of a point in a frame. */
struct wb_take_place {
    uint32_t point;    /* index into the points */
    float position[3]; /* m */
};

struct wb_take_frame {
    int32_t number; /* in the file */
    double t;       /* s, the file's clock */
    size_t first;   /* index of its first place; they end at `first` of the next frame */
};

/* An analogue channel, in the file's unit. */
struct wb_take_channel {
    char name[64], unit[16];
};

struct wb_take {
    char format[40]; /* for messages: "Motive CSV 1.23" */
    double rate;     /* frames/s by the file; 0: unknown */
    size_t n_points, n_frames, n_places;
    struct wb_take_point *points;     /* owned */
    struct wb_take_frame *frames;     /* (n_frames + 1), the last for its `first` only; owned */
    struct wb_take_place *places;     /* owned */
    int n_channels, per_frame;        /* per_frame: readings of each channel per frame */
    struct wb_take_channel *channels; /* owned */
    float *analog;                    /* (n_frames x per_frame x n_channels); owned */
    /* Missing and skipped data. */
    size_t declared_frames; /* number of frames by the header; 0: unknown */
    size_t skipped_rows;    /* rows with a wrong number of cells, truncated or not in order */
    size_t empty_rows;
    size_t first_skipped; /* line of the first skipped row; 0: none */
    size_t jumps;         /* gaps in the frame numbers */
    size_t jumped;        /* frames missing in these gaps */
    size_t capacity[4];   /* of points, frames, places, analog */
};

void wb_take_release(struct wb_take *take);

/* Whether the cameras measured the point: a marker, labelled or not. */
bool wb_take_is_measured(enum wb_take_kind kind);

/* Converts a frame to a sample with its measured markers only, at most WB_MAX_MARKERS; returns the
 * number of markers that did not fit. `t_ns` is the file's clock. */
size_t wb_take_frame_at(const struct wb_take *take, size_t frame, struct wb_mocap_frame *out);

/* --- for readers --- */

/* Adds a point and returns its index. */
size_t wb_take_add_point(struct wb_take *take, enum wb_take_kind kind, struct wb_span name);
/* Adds a frame; false, and nothing is added, if number and time do not exceed those of the last. */
bool wb_take_add_frame(struct wb_take *take, int32_t number, double t);
/* Adds a position to the last frame. */
void wb_take_add_place(struct wb_take *take, uint32_t point, const double position[3]);
/* Removes the last frame. */
void wb_take_drop_frame(struct wb_take *take);
/* Allocates n more analogue readings, which the caller fills in. */
float *wb_take_add_analog(struct wb_take *take, size_t n);
/* Completes a take that was read with `status`: ends the last frame, counts jumps, and recomputes
 * rounded times. Releases the take on failure. */
WB_MUST_CHECK enum wb_status wb_take_finish(struct wb_take *take, enum wb_status status,
                                            const char *name, struct wb_reason *why);
/* Copies a name: characters other than printable ASCII become '?', outer blanks are removed. */
void wb_take_copy_name(char *to, size_t size, struct wb_span name);
/* The beginning of a cell, for a message. */
struct wb_take_quoted {
    char text[40];
};
struct wb_take_quoted wb_take_quote(struct wb_span cell);
/* m per unit of length, for its name in any spelling; 0: unknown. */
double wb_take_length_unit(struct wb_span name);

#endif
