/* List of the supported protocols. To add one, write a file with a `struct wb_driver` named like
 * the file, and add a line to this list. */
#ifndef WB_DAQ_PROTOCOL_DRIVERS_H
#define WB_DAQ_PROTOCOL_DRIVERS_H

#include "daq/protocol/driver.h"

#define WB_DRIVERS(X)                                                                              \
    X(wb_loadcell_generic)                                                                         \
    X(wb_loadcell_mtsics)                                                                          \
    X(wb_natnet_client)                                                                            \
    X(wb_stage_grbl)                                                                               \
    X(wb_stage_tic)

#define WB_DRIVERS_DECLARE(driver) extern const struct wb_driver driver;
WB_DRIVERS(WB_DRIVERS_DECLARE)
#undef WB_DRIVERS_DECLARE

#define WB_DRIVERS_ADDRESS(driver) &driver,

/* Finds a driver by role and protocol name; NULL: unknown. */
const struct wb_driver *wb_drivers_find(enum wb_role role, const char *protocol);

#endif
