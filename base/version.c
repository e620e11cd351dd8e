#include "base/version.h"

#include "revision.h"

const char *wb_version(void)
{
    return WB_VERSION;
}

const char *wb_version_revision(void)
{
    return WB_REVISION;
}
