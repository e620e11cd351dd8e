/* A take of motion capture from a file: what the readers of Motive's CSV, C3D and TRC make of its
 * bytes.
 *
 * Points are kept sparse, because a file of bare markers has one point for each time that the
 * cameras found a marker again, of which a frame shows few. Which of them are the same marker is
 * for geometry to say (analysis/align/markers.h). A point that is not seen in a frame is missing
 * there; nothing is filled in.
 *
 * A reader either understands the whole file or refuses it, naming file, line and column (of a
 * binary file: what it was reading); rows that are left out are counted in the take.
 */
#ifndef WB_DAQ_TAKE_TAKE_H
#define WB_DAQ_TAKE_TAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"
#include "daq/protocol/sample.h"

enum wb_take_kind {
    WB_TAKE_MARKER,     /* measured, with a name */
    WB_TAKE_UNLABELLED, /* measured; one point for each time it was found again */
    WB_TAKE_SOLVED,     /* where a rigid body's marker should be: filled even when it is lost */
    WB_TAKE_BODY        /* the origin of a rigid body or bone */
};

struct wb_take_point {
    char name[64]; /* cut to fit, printable ASCII */
    enum wb_take_kind kind;
    size_t n_seen; /* frames that have it */
};

/* Where a point was in a frame. */
struct wb_take_place {
    uint32_t point;    /* index into the points */
    float position[3]; /* m */
};

struct wb_take_frame {
    int32_t number; /* as the file counts */
    double t;       /* s, the file's clock */
    size_t first;   /* index of its first place; the next frame's is the end */
};

/* An analogue channel, in the unit that the file names. */
struct wb_take_channel {
    char name[64], unit[16];
};

struct wb_take {
    char format[40]; /* for people: "Motive CSV 1.23" */
    double rate;     /* frames a second as the file says; 0 unknown */
    size_t n_points, n_frames, n_places;
    struct wb_take_point *points;     /* owned */
    struct wb_take_frame *frames;     /* one more than n_frames, for its `first`; owned */
    struct wb_take_place *places;     /* owned */
    int n_channels, per_frame;        /* readings of each channel a frame */
    struct wb_take_channel *channels; /* owned */
    float *analog;                    /* (n_frames x per_frame x n_channels); owned */
    /* What is not there or was left out. */
    size_t declared_frames; /* frames the file announces; 0 unknown */
    size_t skipped_rows;    /* left out: another number of cells, cut off, not in order */
    size_t empty_rows;
    size_t first_skipped; /* line of the first that was left out; 0: none */
    size_t jumps;         /* places where frames are missing between two */
    size_t jumped;        /* frames missing there */
    size_t capacity[4];   /* of points, frames, places, analog */
};

void wb_take_release(struct wb_take *take);

/* Whether cameras measured it: a marker, labelled or not. */
bool wb_take_is_measured(enum wb_take_kind kind);

/* The frame as an instrument would have sent it, its measured markers only, at most WB_MAX_MARKERS;
 * returns how many did not fit. `t_ns` is the file's clock. */
size_t wb_take_frame_at(const struct wb_take *take, size_t frame, struct wb_mocap_frame *out);

/* --- for readers --- */

/* Adds a point; its index. `name` need not end in NUL. */
size_t wb_take_add_point(struct wb_take *take, enum wb_take_kind kind, const char *name, size_t n);
void wb_take_add_frame(struct wb_take *take, int32_t number, double t);
/* To the last frame. */
void wb_take_add_place(struct wb_take *take, uint32_t point, const double position[3]);
/* Takes the last frame out again. */
void wb_take_drop_frame(struct wb_take *take);
/* Room for so many more readings, which the caller fills. */
float *wb_take_add_analog(struct wb_take *take, size_t n);
/* Leaves a row out. */
void wb_take_skip(struct wb_take *take, size_t line);
/* Ends the last frame, counts jumps, and puts times that the file has rounded back on its rate. */
WB_MUST_CHECK enum wb_status wb_take_finish(struct wb_take *take, const char *name,
                                            struct wb_reason *why);
/* Copies a name: printable ASCII, anything else '?', blanks at its ends gone. */
void wb_take_copy_name(char *to, size_t size, const char *from, size_t n);
/* The beginning of a cell, for a message. */
struct wb_take_quoted {
    char text[40];
};
struct wb_take_quoted wb_take_quote(const char *cell, size_t n);
/* m for the name of a unit of length in any spelling; 0: not known. */
double wb_take_length_unit(const char *text, size_t n);

#endif
