/* What only tests ask of daq/acquire/acquisition.h. */
#ifndef WB_DAQ_ACQUIRE_ACQUISITION_PRIVATE_H
#define WB_DAQ_ACQUIRE_ACQUISITION_PRIVATE_H

#include "daq/acquire/acquisition.h"

/* Clears a stop that is over, and the interlock, so that the stage takes commands to move again
 * (those that free a specimen). The interlock is disarmed. */
void wb_acquisition_clear_stop(struct wb_acquisition *acquisition);

/* Index of a role's stream in the recording: the opened roles in the order load, mocap, stage. -1
 * when it is not open. */
int wb_acquisition_stream(const struct wb_acquisition *acquisition, enum wb_role role);

#endif
