#include "base/status.h"

const char *wb_status_text(enum wb_status status)
{
    static const char *const texts[] = {
        [-WB_OK] = "ok",
        [-WB_ERR_ARGUMENT] = "invalid argument",
        [-WB_ERR_MEMORY] = "out of memory",
        [-WB_ERR_IO] = "input or output failed",
        [-WB_ERR_NOT_FOUND] = "no such file or name",
        [-WB_ERR_FORMAT] = "wrong format",
        [-WB_ERR_BUSY] = "in use by another program",
        [-WB_ERR_PERMISSION] = "permission denied",
        [-WB_ERR_TIMEOUT] = "no answer in time",
        [-WB_ERR_UNSUPPORTED] = "not supported",
        [-WB_ERR_EXISTS] = "exists already",
        [-WB_ERR_DATA] = "unusable data",
        [-WB_ERR_CONVERGENCE] = "no convergence",
    };
    const int index = -(int)status;
    const int n = (int)(sizeof texts / sizeof texts[0]);
    return index >= 0 && index < n ? texts[index] : "unknown status";
}
