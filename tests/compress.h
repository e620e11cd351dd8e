/* Compressed recordings (.wbr.zst). */
#ifndef WB_TESTS_COMPRESS_H
#define WB_TESTS_COMPRESS_H

#include <stdlib.h>

#include "base/compress.h"
#include "base/file.h"

/* Compresses a closed recording to `target`. */
static inline enum wb_status compress_recording(const char *path, const char *target)
{
    char *bytes = NULL;
    void *packed = NULL;
    size_t size, packed_size;
    WB_TRY(wb_file_read(path, &bytes, &size));
    enum wb_status status =
        wb_compress(bytes, size, WB_COMPRESS_STORED, path, &packed, &packed_size);
    if (status == WB_OK)
        status = wb_file_write(target, packed, packed_size);
    free(packed);
    free(bytes);
    return status;
}

#endif
