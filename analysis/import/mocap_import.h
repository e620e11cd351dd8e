/* Makes a recording from a take of motion capture and a force, from its own file or an analogue
 * channel of the same file.
 *
 * The recording keeps the files' bytes; a replay reads them again with the same readers. Its clock
 * is that of the take. Two values that the files may lack are found here: the lag between the two
 * clocks (analysis/import/sync.h) and the tare, the mean force before the motion begins.
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
    const char *columns;    /* of the force file, wb_table_columns_find(); NULL: detected */
    const char *channel;    /* "NAME" or "NAME:UNIT"; NULL: the only force channel */
    const char *specimen_path, *rig_path;
    const char *notes;  /* NULL: none */
    const char *output; /* must not exist */
    bool tap, reversal; /* permitted methods to synchronize the clocks; neither: both */
    double offset;      /* s, time of the take less that of the force file; NaN: to be found */
    double tare;        /* N; NaN: to be found before the motion */
};

/* Settings `offset` and `tare`. */
extern const struct wb_setting_table wb_mocap_import_table;

struct wb_mocap_import {
    char format[40];
    size_t n_frames, n_points; /* points: columns of measured markers */
    double rate, duration;     /* 1/s, s */
    size_t skipped_rows, first_skipped, empty_rows, jumps, jumped;
    size_t missing_frames; /* announced by the file but absent */
    /* Stitching. */
    int n_markers;
    size_t n_stitched; /* columns that contained one of our markers at some time */
    double missing;    /* part of all positions of our markers that are missing */
    /* Force. */
    bool has_force;
    char channel[64], unit[16];        /* of a take; "": none */
    char columns[WB_FORCE_TABLE_LIST]; /* of a table; "": none */
    size_t n_readings, force_skipped;
    struct wb_sync sync;
    double filter_delay;         /* s, of the rig */
    double offset;               /* s: time of the recording less that of the force file */
    double tare, tare_deviation; /* N */
    long tare_samples;
    double motion_start; /* s, the recording's clock */
    bool complete;       /* no announced frame is missing, no row was left out */
};

/* Makes the recording. On failure no file remains. WB_ERR_DATA if the clocks cannot be
 * synchronized: result->sync.reason contains the reason. Every failure is logged. */
WB_MUST_CHECK enum wb_status wb_mocap_import_run(struct wb_mocap_import *result,
                                                 const struct wb_mocap_import_request *request);

#endif
