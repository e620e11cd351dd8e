#include "daq/protocol/drivers.h"
#include "daq/protocol/drivers_private.h"

#include <string.h>

#define ADDRESS(driver) &driver,
const struct wb_driver *const wb_drivers[] = {WB_DRIVERS(ADDRESS) NULL};

const struct wb_driver *wb_drivers_find(enum wb_role role, const char *protocol)
{
    for (const struct wb_driver *const *at = wb_drivers; *at; at++)
        if ((*at)->role == role && strcmp((*at)->name, protocol) == 0)
            return *at;
    return NULL;
}
