/* Detects a drop of the force during loading: the wire or the strand broke, or the wire slips in
 * its clamp. The test is then stopped, because later readings would be meaningless.
 */
#ifndef WB_DAQ_TEST_FORCE_DROP_H
#define WB_DAQ_TEST_FORCE_DROP_H

#include <stdbool.h>

#include "daq/test/start_check.h"

#define WB_FORCE_DROP_MEAN 4 /* readings that are averaged */

/* Initial state of a loading: all zero except `noise` and `share`. */
struct wb_force_drop {
    double noise; /* N, standard deviation of a reading at rest */
    double share; /* allowed drop as a fraction of the peak; 0: not checked */
    int n;
    double recent[WB_FORCE_DROP_MEAN]; /* N */
    double peak;                       /* N, largest mean of the recent readings */
};

/* Adds a reading (N, strand tension) during loading. True if the mean force fell from its peak by
 * more than `share` and by more than noise can explain; `text` then holds the message. */
bool wb_force_drop_add(struct wb_force_drop *drop, double tension, char text[WB_START_CHECK_TEXT]);

#endif
