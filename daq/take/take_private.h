/* Functions of daq/take/take.h that only tests call. */
#ifndef WB_DAQ_TAKE_TAKE_PRIVATE_H
#define WB_DAQ_TAKE_TAKE_PRIVATE_H

#include "daq/take/take.h"

/* Fraction of the positions of measured markers that are missing, over all frames and markers;
 * bodies are counted if there are no markers. */
double wb_take_missing(const struct wb_take *take);

#endif
