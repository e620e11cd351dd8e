/* A take of motion capture, and a force from a file of its own or an analogue channel of the same
 * file, become a recording, as if the bench had recorded them.
 *
 * The recording keeps the files' bytes; a replay reads them again with the same readers. Its clock
 * is that of the take. What the files do not say is found here: the lag between the two clocks
 * (analysis/import/sync.h) and the tare, the mean force before the motion begins.
 */
#ifndef WB_ANALYSIS_IMPORT_MOCAP_IMPORT_H
#define WB_ANALYSIS_IMPORT_MOCAP_IMPORT_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/import/sync.h"
#include "base/setting.h"
#include "base/status.h"
#include "daq/take/force_table.h"

struct wb_mocap_import_request {
    const char *take_path;
    const char *force_path; /* NULL: an analogue channel, or none */
    const char *columns;    /* of the force file, wb_table_columns_find(); NULL: found */
    const char *channel;    /* "NAME" or "NAME:UNIT"; NULL: the only one of a force */
    const char *specimen_path, *rig_path;
    const char *notes;  /* NULL: none */
    const char *output; /* must not exist */
    bool tap, reversal; /* what may bring the clocks together; neither: both may */
    double offset;      /* s, time of the take less that of the force file; NaN: it
                           is sought */
    double tare;        /* N; NaN: found before the motion */
};

/* Offset and tare. */
extern const struct wb_setting_table wb_mocap_import_table;

struct wb_mocap_import {
    char format[40];
    size_t n_frames, n_points; /* points: columns of measured markers */
    double rate, duration;     /* 1/s, s */
    size_t skipped_rows, first_skipped, empty_rows, jumps, jumped;
    size_t missing_frames; /* that the file announces and does not hold */
    /* Stitching. */
    int n_markers;
    size_t n_stitched; /* points that were ours at some time */
    double missing;    /* part of places of our markers where they were not seen */
    size_t strays;
    bool symmetric;
    /* Force. */
    bool has_force;
    char channel[64], unit[16];        /* of a take; "": none */
    char columns[WB_FORCE_TABLE_LIST]; /* of a table; "": none */
    size_t n_readings, force_skipped;
    struct wb_sync sync;
    double filter_delay;         /* s, of the rig */
    double offset;               /* s: time of the recording less that of the force's file */
    double tare, tare_deviation; /* N */
    long tare_samples;
    double motion_start; /* s, the recording's clock */
    bool complete;       /* nothing announced is missing, no row was left out */
};

/* Makes the recording. On failure no file is left. WB_ERR_DATA where the two clocks cannot be
 * brought together: result->sync.reason says why. Every failure is logged. */
WB_MUST_CHECK enum wb_status wb_mocap_import_run(struct wb_mocap_import *result,
                                                 const struct wb_mocap_import_request *request);

#endif
