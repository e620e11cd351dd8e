/* The clamp against the stage, all the way: a clamp that jams, a coupling that slips or a motor
 * that loses its steps is seen by the cameras, while the stage goes on counting. The first
 * millimetres are judged more closely (first_motion.h).
 */
#ifndef WB_DAQ_TEST_CLAMP_WATCH_H
#define WB_DAQ_TEST_CLAMP_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/test/start_check.h"
#include "daq/test/tip_watch.h"

/* All zero is the beginning. */
struct wb_clamp_watch {
    bool has_end; /* which end of the wire is the clamp's: chosen by the first report, because */
    int end;      /* later a bent tip may have moved more */
    int n_off;    /* reports in a row that the cameras contradict */
};

/* The first call is for a stage that has gone some millimetres down.
 * A report of the stage that arrived at t_ns with that `travel` (m, down from the start), which may
 * be `ahead` (m) off what the cameras saw last. True where the clamp is somewhere else, by more
 * than 2 mm and 15 % of the travel, at three reports in a row; `text` says where. A clamp that the
 * cameras have not seen for 0.3 s is not judged. */
bool wb_clamp_watch_add(struct wb_clamp_watch *watch, const struct wb_tip_watch *tip, int64_t t_ns,
                        double travel, double ahead, char text[WB_START_CHECK_TEXT]);

#endif
