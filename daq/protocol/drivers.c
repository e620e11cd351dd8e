#include "daq/protocol/drivers.h"

#include <string.h>

#include "base/config.h"

const struct wb_driver *wb_drivers_find(enum wb_role role, const char *protocol)
{
    static const struct wb_driver *const drivers[] = {WB_DRIVERS(WB_DRIVERS_ADDRESS)};
    for (size_t i = 0; i < WB_COUNT(drivers); i++)
        if (drivers[i]->role == role && strcmp(drivers[i]->name, protocol) == 0)
            return drivers[i];
    return NULL;
}
