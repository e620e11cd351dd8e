/* What only tests ask of daq/protocol/drivers.h. */
#ifndef WB_DAQ_PROTOCOL_DRIVERS_PRIVATE_H
#define WB_DAQ_PROTOCOL_DRIVERS_PRIVATE_H

#include "daq/protocol/drivers.h"

/* All of them; NULL is the end. */
extern const struct wb_driver *const wb_drivers[];

#endif
