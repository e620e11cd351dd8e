/* What of a build and its machine may change the last digits of a result, or the bytes of a figure:
 * compiler, libraries, and the class of the processor by which kernels are chosen. */
#ifndef WB_BASE_BUILD_H
#define WB_BASE_BUILD_H

#include "base/json.h"
#include "base/status.h"

/* Adds `version` and `revision` of this program, `compiler`, its `options` that choose machine
 * code, `processor` (vector instructions, and what OpenBLAS takes it for) and `libraries`, the
 * shared ones that are loaded: a list of `file` and `sha256`, sorted by file. Names hold no
 * folders. */
WB_MUST_CHECK enum wb_status wb_build_put(struct wb_json *object);

#endif
