/* Packets between the recorder and its live views: fixed layout, through a socket between two
 * processes of one program. Each packet begins with a header, whose version and size the reader
 * checks.
 *
 * Units are SI. Unknown numbers are NaN.
 */
#ifndef WB_LIVE_LIVE_FRAME_H
#define WB_LIVE_LIVE_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/acquire/interlock.h"
#include "daq/protocol/specimen.h"

#define WB_LIVE_FRAME_VERSION 1
#define WB_LIVE_FRAME_POINTS 64 /* points of the curve per frame */
#define WB_LIVE_FRAME_TEXT 256

enum wb_live_frame_kind {
    WB_LIVE_FRAME_STATE = 1, /* struct wb_live_frame */
    WB_LIVE_FRAME_MESSAGE,   /* struct wb_live_frame_message */
    WB_LIVE_FRAME_KEY        /* struct wb_live_frame_key, from the view to the recorder */
};

struct wb_live_frame_header {
    uint32_t kind, version, size; /* size: of the whole packet, bytes */
};

/* State of the test. */
enum wb_live_frame_word {
    WB_LIVE_FRAME_CONNECTING, /* waiting for the instruments */
    WB_LIVE_FRAME_READY,      /* all instruments reply; start check and tare */
    WB_LIVE_FRAME_TESTING,
    WB_LIVE_FRAME_HELD,    /* by the operator, who may resume it */
    WB_LIVE_FRAME_STOPPED, /* ended by a limit or the operator; the stage has stopped */
    WB_LIVE_FRAME_FAULTED, /* failed, or the stage did not confirm its stop */
    WB_LIVE_FRAME_DONE
};

/* A point of the curve. */
struct wb_live_frame_point {
    float deflection, force; /* m; N, strand tension */
    int32_t cycle;           /* from 1 */
};

struct wb_live_frame_stream {
    double rate; /* valid samples/s */
    uint64_t samples, missing, gaps, drops;
    bool is_ready, is_lost, is_gone, is_losing;
};

struct wb_live_frame {
    struct wb_live_frame_header header;
    uint64_t number;         /* of the frame, from 1, including dropped frames */
    uint64_t frames_dropped; /* frames not sent because this view was too slow */
    uint64_t points_dropped; /* points of the curve, for the same reason */
    enum wb_live_frame_word word;
    char phase[16];                /* as in struct wb_bend_test_status */
    char text[WB_LIVE_FRAME_TEXT]; /* reason of the end, or state of a hold; "" while it runs */
    int32_t cycle, cycles;
    double elapsed, time_left; /* s of host time */
    double force, peak;        /* N, strand tension: present, and largest so far */
    double deflection, travel; /* m */
    struct wb_live_frame_stream stream[WB_INTERLOCK_ROLES]; /* by role */
    double disk_lag;  /* s, age of the oldest data that are not on the disk */
    double disk_fill; /* used fraction of the writer's queue, 0 to 1 */
    bool is_disk_failing, is_disk_late;
    uint64_t bytes; /* received from the instruments */
    int32_t n_markers;
    bool are_markers_found; /* all markers were seen in one frame, and are tracked since then */
    uint32_t seen;          /* bit i: marker i was measured in the last frame of the cameras */
    float marker[WB_SPECIMEN_MAX_MARKERS][2]; /* m, last seen position relative to the clamp's
                                                 marker: along the wire at rest, and up */
    int32_t n_points;
    struct wb_live_frame_point point[WB_LIVE_FRAME_POINTS]; /* new since the last frame sent */
};

/* A message of the log. */
struct wb_live_frame_message {
    struct wb_live_frame_header header;
    int32_t level; /* enum wb_log_level */
    char text[WB_LIVE_FRAME_TEXT];
};

#define WB_LIVE_FRAME_KEYS "mhrq" /* mark, hold, resume, stop */

struct wb_live_frame_key {
    struct wb_live_frame_header header;
    int32_t key; /* one of WB_LIVE_FRAME_KEYS */
};

/* Header of a packet of this kind. */
static inline struct wb_live_frame_header wb_live_frame_header(enum wb_live_frame_kind kind,
                                                               uint32_t size)
{
    return (struct wb_live_frame_header){(uint32_t)kind, WB_LIVE_FRAME_VERSION, size};
}

/* Whether `n` bytes are a complete packet of this kind. */
static inline bool wb_live_frame_is(const struct wb_live_frame_header *header, long n,
                                    enum wb_live_frame_kind kind, uint32_t size)
{
    return n == (long)size && header->kind == (uint32_t)kind &&
           header->version == WB_LIVE_FRAME_VERSION && header->size == size;
}

/* Name of the state: "connecting", "ready", "test in progress", "held", "stopped", "faulted",
 * "done". */
static inline const char *wb_live_frame_word(enum wb_live_frame_word word)
{
    static const char *const words[] = {
        "connecting", "ready", "test in progress", "held", "stopped", "faulted", "done"};
    return words[word];
}

#endif
