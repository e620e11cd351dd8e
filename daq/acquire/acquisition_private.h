/* Functions of daq/acquire/acquisition.h that only tests call. */
#ifndef WB_DAQ_ACQUIRE_ACQUISITION_PRIVATE_H
#define WB_DAQ_ACQUIRE_ACQUISITION_PRIVATE_H

#include "daq/acquire/acquisition.h"

/* Clears a completed stop and disarms the interlock, so that motion commands are accepted again (to
 * free a specimen). */
void wb_acquisition_clear_stop(struct wb_acquisition *acquisition);

/* Index of a role's stream in the recording, counting the opened roles in the order load, mocap,
 * stage; -1 if it is not open. */
int wb_acquisition_stream(const struct wb_acquisition *acquisition, enum wb_role role);

#endif
