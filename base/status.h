/* Status codes and error reporting.
 *
 * Every function that can fail returns an enum wb_status: WB_OK or a negative code. The message is
 * logged once, with wb_fail(), where the detail is known; callers pass the code on with WB_TRY().
 * Results go through out-parameters, which are written only on success.
 */
#ifndef WB_BASE_STATUS_H
#define WB_BASE_STATUS_H

#include "base/log.h"

enum wb_status {
    WB_OK = 0,
    WB_ERR_ARGUMENT = -1,    /* wrong use of a function, or a setting out of range */
    WB_ERR_MEMORY = -2,      /* out of memory */
    WB_ERR_IO = -3,          /* a file, socket or port could not be read or written */
    WB_ERR_NOT_FOUND = -4,   /* a file, port, key or name does not exist */
    WB_ERR_FORMAT = -5,      /* bytes or text do not follow their format */
    WB_ERR_BUSY = -6,        /* another process holds the port or file */
    WB_ERR_PERMISSION = -7,  /* no permission to open it */
    WB_ERR_TIMEOUT = -8,     /* no answer in time */
    WB_ERR_UNSUPPORTED = -9, /* the instrument or format does not support this */
    WB_ERR_EXISTS = -10,     /* would overwrite something */
    WB_ERR_DATA = -11,       /* the data do not serve the purpose; the message says why */
    WB_ERR_CONVERGENCE = -12 /* an iteration did not converge and the caller cannot continue */
};

#define WB_MUST_CHECK __attribute__((warn_unused_result))

/* Short lower-case text of a status ("no such file or name"); never NULL. */
const char *wb_status_text(enum wb_status status);

/* Logs the message at error level in the file's WB_LOG_DOMAIN and evaluates to `code`.
 * A macro, so that the compiler sees that the caller returns an error. */
#define wb_fail(code, ...) (wb_log(WB_LOG_ERROR, WB_LOG_DOMAIN, __VA_ARGS__), (code))

/* Returns early with the status of `call` if it failed. Only where nothing needs release. */
#define WB_TRY(call)                                                                               \
    do {                                                                                           \
        enum wb_status wb_try_status_ = (call);                                                    \
        if (wb_try_status_ != WB_OK)                                                               \
            return wb_try_status_;                                                                 \
    } while (0)

#endif
