/* What only tests ask of daq/take/take.h. */
#ifndef WB_DAQ_TAKE_TAKE_PRIVATE_H
#define WB_DAQ_TAKE_TAKE_PRIVATE_H

#include "daq/take/take.h"

/* Places of the measured markers that one frame lacks, over all frames and markers, as a part of
 * all; bodies count as points where there are no markers. */
double wb_take_missing(const struct wb_take *take);

#endif
