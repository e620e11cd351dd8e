/* Declarations of daq/protocol/drivers.c that only tests use. */
#ifndef WB_DAQ_PROTOCOL_DRIVERS_PRIVATE_H
#define WB_DAQ_PROTOCOL_DRIVERS_PRIVATE_H

#include "daq/protocol/drivers.h"

/* All drivers, terminated by NULL. */
extern const struct wb_driver *const wb_drivers[];

#endif
