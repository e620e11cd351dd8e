/* Properties of a build and its machine that may change the last digits of a result, or the bytes
 * of a figure: compiler, libraries, and the processor class by which kernels are chosen. */
#ifndef WB_BASE_BUILD_H
#define WB_BASE_BUILD_H

#include "base/json.h"
#include "base/status.h"

/* Adds `version` and `revision` of this program, `compiler`, its `options` that affect machine
 * code, `processor` (vector instructions, and OpenBLAS's name for it) and `libraries`, the loaded
 * shared libraries: a list of `file` and `sha256`, sorted by file. Names contain no folders. */
WB_MUST_CHECK enum wb_status wb_build_put(struct wb_json *object);

#endif
