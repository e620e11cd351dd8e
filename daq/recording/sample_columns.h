/* A recording's samples, events and clock probes as tables in memory. The same rows in the same
 * order as the CSV tables of daq/recording/export.h; lengths are in metres. */
#ifndef WB_DAQ_RECORDING_SAMPLE_COLUMNS_H
#define WB_DAQ_RECORDING_SAMPLE_COLUMNS_H

#include "base/columns.h"
#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/recording/recording.h"
#include "daq/recording/replay.h"

enum {
    WB_SAMPLE_COLUMNS_LOAD,
    WB_SAMPLE_COLUMNS_MOCAP, /* a row for each marker of a frame */
    WB_SAMPLE_COLUMNS_STAGE,
    WB_SAMPLE_COLUMNS_EVENTS,
    WB_SAMPLE_COLUMNS_CLOCK,
    WB_SAMPLE_COLUMNS_TABLES
};

/* The table's name, "load", or -1 for a name that none has. */
int wb_sample_columns_find(const char *name);

/* Time of the first intact chunk; 0 where there is none. WB_ERR_DATA where the database breaks off
 * before one. */
WB_MUST_CHECK enum wb_status wb_sample_columns_start(struct wb_recording *recording,
                                                     int64_t *first_ns);

/* What a stage was doing, as tables name it: "idle". */
const char *wb_sample_columns_state(enum wb_stage_state state);

/* Decodes the whole recording. t_s counts from the first intact chunk, t_ns is the host's monotonic
 * clock. When the database breaks off, WB_ERR_DATA is returned and the tables hold what comes
 * before it; after any other failure they are empty. The caller releases each table in both cases.
 * *counts is written in every case. */
WB_MUST_CHECK enum wb_status
wb_sample_columns_read(struct wb_columns tables[WB_SAMPLE_COLUMNS_TABLES],
                       struct wb_recording *recording, const struct wb_rig *rig,
                       struct wb_replay_counts *counts);

#endif
