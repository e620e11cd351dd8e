/* Whether the load cell is due for a check: compares the age of the last entry in the rig's log of
 * checks (check_log.h) with load_cell.check_due_days. */
#ifndef WB_DAQ_TEST_CHECK_DUE_H
#define WB_DAQ_TEST_CHECK_DUE_H

#include <stdint.h>

#include "daq/protocol/rig.h"
#include "daq/test/check_log.h"

#define WB_CHECK_DUE_TEXT 768

enum wb_check_due {
    WB_CHECK_DUE_HOLDS,   /* recent enough, or the rig file requires no checks */
    WB_CHECK_DUE_LATE,    /* older than check_due, or its date is in the future: a test warns */
    WB_CHECK_DUE_TOO_LATE /* older than twice check_due, or missing: no test is started */
};

/* Judges the last check at `now_s`, seconds since 1970-01-01 UTC. `text` receives the reason and
 * the command to run; "" for WB_CHECK_DUE_HOLDS. A check of a cell with another serial number does
 * not count. A check that failed counts here; bend_recording.c warns about it. */
enum wb_check_due wb_check_due(const struct wb_rig_load_cell *cell, const char *rig_path,
                               int64_t now_s, char text[WB_CHECK_DUE_TEXT]);

#endif
