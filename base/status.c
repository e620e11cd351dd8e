#include "base/status.h"

const char *wb_status_text(enum wb_status status)
{
    switch (status) {
    case WB_OK:
        return "ok";
    case WB_ERR_ARGUMENT:
        return "invalid argument";
    case WB_ERR_MEMORY:
        return "out of memory";
    case WB_ERR_IO:
        return "input or output failed";
    case WB_ERR_NOT_FOUND:
        return "no such file or name";
    case WB_ERR_FORMAT:
        return "wrong format";
    case WB_ERR_BUSY:
        return "in use by another program";
    case WB_ERR_PERMISSION:
        return "permission denied";
    case WB_ERR_TIMEOUT:
        return "no answer in time";
    case WB_ERR_UNSUPPORTED:
        return "not supported";
    case WB_ERR_EXISTS:
        return "exists already";
    case WB_ERR_DATA:
        return "unusable data";
    case WB_ERR_CONVERGENCE:
        return "no convergence";
    }
    return "unknown status";
}
