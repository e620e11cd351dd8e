/* Visits all rows of a recording in order of writing, by merging its tables. */
#include <string.h>

#include "daq/recording/recording_private.h"

#define WB_LOG_DOMAIN "recording"

struct side {
    struct wb_recording_cursor cursor;
    struct wb_recording_row row;
    bool has_row;
};

static void step(struct side *side)
{
    while ((side->has_row = wb_recording_cursor_step(&side->cursor))) {
        wb_recording_read_row(&side->cursor, &side->row);
        if (!side->row.is_nothing)
            return;
        wb_recording_cursor_break(&side->cursor, SQLITE_CORRUPT);
    }
}

/* The table with the next row in order of writing; WB_RECORDING_TABLES at the end. In schema 1 each
 * table has its own numbers, so the tables follow each other. */
static int find_next(const struct side *sides, int schema)
{
    int next = WB_RECORDING_TABLES;
    for (int i = 0; i < WB_RECORDING_TABLES; i++) {
        if (!sides[i].has_row)
            continue;
        if (next == WB_RECORDING_TABLES ||
            (schema >= 2 && sides[i].row.number < sides[next].row.number))
            next = i;
    }
    return next;
}

enum wb_status wb_recording_scan(struct wb_recording *recording,
                                 enum wb_status (*visit)(void *context,
                                                         const struct wb_recording_row *row),
                                 void *context, bool *broken)
{
    struct side sides[WB_RECORDING_TABLES];
    enum wb_status status = WB_OK;
    *broken = false;
    for (int i = 0; i < WB_RECORDING_TABLES; i++) {
        if (wb_recording_cursor_open(&sides[i].cursor, recording, (enum wb_recording_kind)i, NULL,
                                     false) == WB_ERR_MEMORY)
            status = WB_ERR_MEMORY;
        step(&sides[i]);
    }
    int next;
    while (status == WB_OK && (next = find_next(sides, recording->schema)) < WB_RECORDING_TABLES) {
        status = visit(context, &sides[next].row);
        step(&sides[next]);
    }
    for (int i = 0; i < WB_RECORDING_TABLES; i++) {
        if (status == WB_OK && (sides[i].cursor.code & 0xff) == SQLITE_NOMEM)
            status = wb_recording_fail(recording, SQLITE_NOMEM, "read");
        *broken |= sides[i].cursor.code != SQLITE_DONE;
        wb_recording_cursor_close(&sides[i].cursor);
    }
    return status;
}
