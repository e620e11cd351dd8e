/* A force that falls while the wire is bent further: the wire or the strand broke, or the wire
 * slips in its clamp. What follows measures nothing, and the stage would go on to the end.
 */
#ifndef WB_DAQ_TEST_FORCE_DROP_H
#define WB_DAQ_TEST_FORCE_DROP_H

#include <stdbool.h>

#include "daq/test/start_check.h"

#define WB_FORCE_DROP_MEAN 4 /* readings that are averaged */

/* All zero, but for its first two members, is the beginning of a way down. */
struct wb_force_drop {
    double noise; /* N, standard deviation of a reading at rest */
    double share; /* of the peak that the force may fall by; 0: not watched */
    int n;
    double recent[WB_FORCE_DROP_MEAN]; /* N */
    double peak;                       /* N, of the mean of the recent ones */
};

/* A reading (N, of the strand's tension) on the way down. True where the force fell from its peak
 * by more than the share and by more than its noise explains; `text` says what happened to the
 * specimen. */
bool wb_force_drop_add(struct wb_force_drop *drop, double tension, char text[WB_START_CHECK_TEXT]);

#endif
