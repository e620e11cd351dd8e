/* Whether the load cell's check still holds: the age of its last entry in the log beside the rig
 * file (check_log.h) against load_cell.check_due_days. */
#ifndef WB_DAQ_TEST_CHECK_DUE_H
#define WB_DAQ_TEST_CHECK_DUE_H

#include <stdint.h>

#include "daq/protocol/rig.h"
#include "daq/test/check_log.h"

#define WB_CHECK_DUE_TEXT 768

enum wb_check_due {
    WB_CHECK_DUE_HOLDS,   /* or the rig file does not ask */
    WB_CHECK_DUE_LATE,    /* older than check_due, or its date lies ahead: a test warns */
    WB_CHECK_DUE_TOO_LATE /* older than twice of it, or there is none: a test is refused */
};

/* At `now_s`, seconds since 1970-01-01 UTC. `text` says why, with the command that mends it; ""
 * when the check holds. A check of a cell with another serial number is none of this one. Whether
 * the check passed is another matter (bend_recording.c warns of it). */
enum wb_check_due wb_check_due(const struct wb_rig_load_cell *cell, const char *rig_path,
                               int64_t now_s, char text[WB_CHECK_DUE_TEXT]);

#endif
