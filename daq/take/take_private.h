/* Functions of daq/take/take.h that only tests call. */
#ifndef WB_DAQ_TAKE_TAKE_PRIVATE_H
#define WB_DAQ_TAKE_TAKE_PRIVATE_H

#include "daq/take/take.h"

/* Fraction of the marker positions that are missing, over all frames and measured markers. For a
 * take without markers, the same of its rigid bodies. */
double wb_take_missing(const struct wb_take *take);

#endif
