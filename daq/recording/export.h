/* A recording's samples as CSV tables, for people and other programs. */
#ifndef WB_DAQ_RECORDING_EXPORT_H
#define WB_DAQ_RECORDING_EXPORT_H

#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/recording/recording.h"

struct wb_export_counts {
    uint64_t load, mocap, stage, events, clock; /* rows written (mocap: one a marker) */
    uint64_t damaged_chunks;                    /* left out */
};

/* Decodes the recording and writes load.csv, mocap.csv, stage.csv, events.csv and clock.csv into
 * the existing folder; each appears whole or not at all. The first line is a comment ('#') with
 * `source` (what the file comes from) and, where it is so, the words 'virtual rig'; the second
 * names the columns with their units. t_s counts from the first chunk, t_ns is the host's monotonic
 * clock. When the database breaks off, what comes before is written and WB_ERR_DATA returned. */
WB_MUST_CHECK enum wb_status wb_export_csv(struct wb_recording *recording, const struct wb_rig *rig,
                                           const char *source, const char *folder,
                                           struct wb_export_counts *counts);

#endif
