/* Creates the recording of a test: its meta values and its streams. */
#ifndef WB_DAQ_TEST_BEND_RECORDING_H
#define WB_DAQ_TEST_BEND_RECORDING_H

#include <stdbool.h>

#include "base/status.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "daq/recording/recording.h"

struct wb_bend_recording {
    const char *path;                     /* must not exist */
    const char *rig_path, *specimen_path; /* files whose full text is stored */
    const char *rig_text;                 /* stored instead of the file's text; NULL: the file's */
    const char *specimen_text;            /* stored instead of the file's text; NULL: the file's */
    const struct wb_rig *rig;
    const struct wb_specimen *specimen;
    const char *operator_name, *notes; /* may be NULL */
    int cycles;
    double travel;      /* m */
    double dwell;       /* s, at the largest deflection of each cycle */
    const char *speeds; /* mm/s, one per cycle, separated by commas; "": the rig's speed */
    int64_t monotonic_start_ns;
    bool imported; /* made from files of another system: the caller adds the streams; cycles,
                      travel, dwell and speeds are unknown */
};

/* Creates the file with streams load, mocap and stage (numbers 0 to 2) and the meta values of
 * docs/file-formats.md. Adds the last line of the rig's log of checks (daq/test/check_log.h) as
 * `load_cell_check`, and for a virtual rig `virtual` and its true values. The specimen's `wire`
 * names the wire file. On failure no file is left behind. */
WB_MUST_CHECK enum wb_status wb_bend_recording_create(struct wb_recording **out,
                                                      const struct wb_bend_recording *description);

#endif
