/* Samples, events and clock probes of a recording as tables in memory, with the same rows in the
 * same order as the CSV tables of daq/recording/export.h; lengths are in metres. */
#ifndef WB_DAQ_RECORDING_SAMPLE_COLUMNS_H
#define WB_DAQ_RECORDING_SAMPLE_COLUMNS_H

#include "base/columns.h"
#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/recording/recording.h"
#include "daq/recording/replay.h"

enum {
    WB_SAMPLE_COLUMNS_LOAD,
    WB_SAMPLE_COLUMNS_MOCAP, /* one row per marker of a frame */
    WB_SAMPLE_COLUMNS_STAGE,
    WB_SAMPLE_COLUMNS_EVENTS,
    WB_SAMPLE_COLUMNS_CLOCK,
    WB_SAMPLE_COLUMNS_TABLES
};

/* Index of the table with this name, such as "load"; -1: unknown. */
int wb_sample_columns_find(const char *name);

/* Decodes the whole recording. t_s counts from the first intact chunk, t_ns is the host's monotonic
 * clock. WB_ERR_DATA: the database is damaged, and the tables hold all readable rows; after any
 * other failure they are empty. The caller releases each table in both cases. *counts is written in
 * every case. */
WB_MUST_CHECK enum wb_status
wb_sample_columns_read(struct wb_columns tables[WB_SAMPLE_COLUMNS_TABLES],
                       struct wb_recording *recording, const struct wb_rig *rig,
                       struct wb_replay_counts *counts);

#endif
