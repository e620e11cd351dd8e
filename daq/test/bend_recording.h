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
    const char *rig_path, *specimen_path; /* stored whole */
    const char *rig_text;                 /* stored in place of the file's; NULL: the file's */
    const char *specimen_text;            /* stored in place of the file's; NULL: the file's */
    const struct wb_rig *rig;
    const struct wb_specimen *specimen;
    const char *operator_name, *notes; /* may be NULL */
    int cycles;
    double travel;      /* m */
    double dwell;       /* s, at the turn of each cycle */
    const char *speeds; /* mm/s, of the cycles in turn; "": the rig's */
    int64_t monotonic_start_ns;
    bool imported; /* from files: made elsewhere at another time, and the caller adds the streams;
                      cycles, travel, dwell and speeds are not known */
};

/* Creates the file with streams load, mocap and stage (numbers 0 to 2) and the meta values of
 * docs/file-formats.md; with a log of checks beside the rig file (daq/test/check_log.h) also its
 * last line as `load_cell_check`; of a virtual rig also `virtual` and its truth. The wire file is
 * found from the specimen's `wire`. When this fails no file is left behind. */
WB_MUST_CHECK enum wb_status wb_bend_recording_create(struct wb_recording **out,
                                                      const struct wb_bend_recording *description);

#endif
