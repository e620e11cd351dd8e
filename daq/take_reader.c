#include "daq/take_reader.h"

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

enum wb_status wb_take_read(struct wb_take *take, const char *name, const uint8_t *bytes, size_t n,
                            const struct wb_take_reader **reader, struct wb_reason *why)
{
    memset(take, 0, sizeof *take);
    for (size_t i = 0; i < WB_COUNT(readers); i++) {
        if (!readers[i]->is(bytes, n))
            continue;
        if (reader)
            *reader = readers[i];
        return readers[i]->read(take, name, bytes, n, why);
    }
    return wb_fail_to(why, WB_ERR_FORMAT,
                      "%s:1: column 1: no take of motion capture: expected a CSV export of Motive "
                      "('Format Version' or 'comment'), a TRC ('PathFileType') or a C3D file",
                      name);
}
