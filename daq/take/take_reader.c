#include "daq/take/take_reader.h"

#include <string.h>

#include "base/config.h"

#define WB_LOG_DOMAIN "take"

static const struct wb_take_reader *const readers[] = {&wb_c3d, &wb_trc, &wb_motive_csv};

const struct wb_take_reader *wb_take_reader_find(const char *name)
{
    for (size_t i = 0; i < WB_COUNT(readers); i++)
        if (strcmp(readers[i]->name, name) == 0)
            return readers[i];
    return NULL;
}

const struct wb_take_reader *wb_take_reader_detect(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < WB_COUNT(readers); i++)
        if (readers[i]->is(bytes, n))
            return readers[i];
    return NULL;
}

enum wb_status wb_take_read(struct wb_take *take, const char *name, const uint8_t *bytes, size_t n,
                            const struct wb_take_reader **reader, struct wb_reason *why)
{
    const struct wb_take_reader *const found = wb_take_reader_detect(bytes, n);
    memset(take, 0, sizeof *take);
    if (reader)
        *reader = found;
    if (found)
        return found->read(take, name, bytes, n, why);
    return wb_fail_to(
        why, WB_ERR_FORMAT,
        "%s:1: column 1: not a take of motion capture: expected a CSV export of Motive "
        "('Format Version' or 'comment'), a TRC ('PathFileType') or a C3D file; for "
        "the curve of a testing machine use 'wirebench import force'",
        name);
}
