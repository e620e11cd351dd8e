/* Replay: decodes the recorded bytes with the same drivers as during recording, for analysis,
 * quicklook and `wirebench replay`. */
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
 * streams and the settings of its rig. Damaged chunks (CRC) are counted, reported as remarks and
 * skipped. `rate` is relative to the speed of the recording, and the call sleeps between chunks; 0:
 * as fast as possible. An interrupt (base/interrupt.h) ends the call with WB_OK. A stream with an
 * unknown protocol is skipped with a warning. If the database is damaged, all readable chunks are
 * delivered and WB_ERR_DATA is returned. *counts is written in every case. */
WB_MUST_CHECK enum wb_status wb_replay_run(struct wb_recording *recording, const struct wb_rig *rig,
                                           const struct wb_sink *sink, double rate,
                                           struct wb_replay_counts *counts);

/* Reads the rig from the meta values of a recording; WB_ERR_DATA: the recording has none. */
WB_MUST_CHECK enum wb_status wb_replay_rig(struct wb_recording *recording, struct wb_rig *rig);

#endif
