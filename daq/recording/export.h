/* The samples of a recording as rows of tables, and as CSV files. */
#ifndef WB_DAQ_RECORDING_EXPORT_H
#define WB_DAQ_RECORDING_EXPORT_H

#include <stdint.h>

#include "base/columns.h"
#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/recording/recording.h"
#include "daq/recording/replay.h"

/* Receives a row of a table (sample_columns.h), with a cell per column; first_ns is the time of the
 * first intact chunk. */
typedef void wb_export_put(void *context, int table, int64_t first_ns, const union wb_cell *cells);

/* Decodes the whole recording into rows. WB_ERR_DATA: the database is damaged, and all readable
 * rows were delivered. *counts is written in every case. */
WB_MUST_CHECK enum wb_status wb_export_rows(struct wb_recording *recording,
                                            const struct wb_rig *rig, wb_export_put *put,
                                            void *context, struct wb_replay_counts *counts);

struct wb_export_counts {
    uint64_t load, mocap, stage, events, clock; /* rows written (mocap: one per marker) */
    uint64_t damaged_chunks;                    /* skipped */
};

/* Decodes the recording and writes load.csv, mocap.csv, stage.csv, events.csv and clock.csv into
 * the existing folder; each file is complete or missing. The first line is a comment ('#') with
 * `source` (the origin of the data) and, for a virtual rig, the words 'virtual rig'; the second
 * line has the columns with their units. t_s counts from the first chunk, t_ns is the host's
 * monotonic clock. If the database is damaged, all readable rows are written and WB_ERR_DATA is
 * returned. */
WB_MUST_CHECK enum wb_status wb_export_csv(struct wb_recording *recording, const struct wb_rig *rig,
                                           const char *source, const char *folder,
                                           struct wb_export_counts *counts);

#endif
