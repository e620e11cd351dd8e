/* Replay: the recorded bytes through the same drivers as live, for analysis, quicklook and
 * `wirebench replay`. */
#ifndef WB_DAQ_RECORDING_REPLAY_H
#define WB_DAQ_RECORDING_REPLAY_H

#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"
#include "daq/recording/recording.h"

struct wb_replay_counts {
    uint64_t chunks, damaged_chunks, bytes;
    uint64_t load_samples, mocap_frames, stage_reports;
};

/* Decodes the whole recording into `sink`, in order of arrival, with the drivers named by its
 * streams and the settings of its rig. Damaged chunks (CRC) are counted, remarked and skipped.
 * `rate` 0 runs as fast as it can; otherwise 1 is the speed of the recording, and the call sleeps
 * between chunks (interruptible, see base/interrupt.h: then WB_OK and the counts so far). A stream
 * whose protocol no driver knows is left out with a warning. When the database breaks off,
 * WB_ERR_DATA is returned after all before it was delivered. *counts is written in every case. */
WB_MUST_CHECK enum wb_status wb_replay_run(struct wb_recording *recording, const struct wb_rig *rig,
                                           const struct wb_sink *sink, double rate,
                                           struct wb_replay_counts *counts);

/* The rig a recording was made with, from its meta; WB_ERR_DATA when it has none. */
WB_MUST_CHECK enum wb_status wb_replay_rig(struct wb_recording *recording, struct wb_rig *rig);

#endif
