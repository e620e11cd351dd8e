/* Reads the rows of a table and skips damaged pages. */
#include <stdio.h>

#include "base/log.h"
#include "daq/recording/recording_private.h"

#define WB_LOG_DOMAIN "recording"

/* After a damaged page, this many row numbers are tried one by one, which covers the rows of a
 * page. Then the step doubles: with larger damage, intact rows in between may be skipped. */
#define STEPS_OF_ONE 256

/* The columns to select for wb_recording_read_row(). */
static void row_columns(const struct wb_recording *recording, enum wb_recording_kind kind,
                        char *text, size_t size)
{
    snprintf(text, size, "rowid, %s%s", wb_recording_tables[kind].columns,
             recording->schema >= 2       ? ", crc32, chain"
             : kind == WB_RECORDING_CHUNK ? ", crc32"
                                          : "");
}

enum wb_status wb_recording_cursor_open(struct wb_recording_cursor *cursor,
                                        struct wb_recording *recording, enum wb_recording_kind kind,
                                        const char *columns, bool report)
{
    char whole_row[160], sql[240];
    *cursor = (struct wb_recording_cursor){
        .recording = recording, .kind = kind, .last = -1, .before_last = -1, .code = SQLITE_DONE};
    row_columns(recording, kind, whole_row, sizeof whole_row);
    snprintf(sql, sizeof sql, "SELECT %s FROM %s WHERE rowid >= ?", columns ? columns : whole_row,
             wb_recording_tables[kind].name);
    const int code = sqlite3_prepare_v2(recording->db, sql, -1, &cursor->statement, NULL);
    if (code == SQLITE_OK) {
        sqlite3_bind_int64(cursor->statement, 1, -1);
        return WB_OK;
    }
    cursor->code = code;
    if (!report && (code & 0xff) != SQLITE_NOMEM)
        return WB_ERR_DATA;
    if (code == SQLITE_ERROR)
        return wb_fail_also(recording->why, WB_ERR_DATA, "'%s' is damaged: %s", recording->path,
                            sqlite3_errmsg(recording->db));
    return wb_recording_fail(recording, code, "read");
}

static bool is_memory(int code)
{
    return (code & 0xff) == SQLITE_NOMEM;
}

/* Steps to the first row with at least this number. False if it cannot be read or has a lower
 * number than rows that were already read. */
static bool seek(struct wb_recording_cursor *cursor, int64_t number, int *code)
{
    sqlite3_reset(cursor->statement);
    sqlite3_bind_int64(cursor->statement, 1, number);
    *code = sqlite3_step(cursor->statement);
    if (*code != SQLITE_ROW)
        return *code == SQLITE_DONE || is_memory(*code);
    const int64_t found = sqlite3_column_int64(cursor->statement, 0);
    return found > cursor->last && found <= cursor->recording->n_rows_max;
}

/* Steps to the first readable row after a damaged page. */
static int skip_damage(struct wb_recording_cursor *cursor)
{
    int64_t failed = cursor->last, step = 1;
    int code;
    for (int tried = 0; !seek(cursor, failed + step, &code); tried++) {
        failed += step;
        if (failed >= cursor->recording->n_rows_max)
            return SQLITE_DONE;
        if (tried >= STEPS_OF_ONE)
            step *= 2;
    }
    if (step == 1)
        return code;
    int64_t good = failed + step;
    while (good - failed > 1) {
        const int64_t middle = failed + (good - failed) / 2;
        if (seek(cursor, middle, &code))
            good = middle;
        else
            failed = middle;
    }
    return seek(cursor, good, &code) ? code : SQLITE_DONE;
}

/* Truncated pages yield rows in random order. A single number out of order is a damaged row; the
 * rows after it are still accepted. */
static bool is_in_order(struct wb_recording_cursor *cursor)
{
    const int64_t number = sqlite3_column_int64(cursor->statement, 0);
    if (number < 0 || number > cursor->recording->n_rows_max)
        return false;
    if (number > cursor->last)
        cursor->before_last = cursor->last;
    else if (number <= cursor->before_last)
        return false;
    cursor->last = number;
    return true;
}

bool wb_recording_cursor_step(struct wb_recording_cursor *cursor)
{
    if (!cursor->statement)
        return false;
    int code = sqlite3_step(cursor->statement);
    /* A damaged tree may contain cycles: limit the number of steps. */
    for (; cursor->n_steps < cursor->recording->n_rows_max; cursor->n_steps++) {
        if (code == SQLITE_DONE)
            return false;
        if (is_memory(code)) {
            cursor->code = code;
            return false;
        }
        if (code == SQLITE_ROW && is_in_order(cursor)) {
            cursor->n_steps++;
            cursor->n_rows++;
            return true;
        }
        wb_recording_cursor_break(cursor, code);
        code = code == SQLITE_ROW ? sqlite3_step(cursor->statement) : skip_damage(cursor);
    }
    wb_recording_cursor_break(cursor, SQLITE_ROW);
    return false;
}

void wb_recording_cursor_break(struct wb_recording_cursor *cursor, int code)
{
    if (cursor->code != SQLITE_DONE)
        return;
    cursor->code = code == SQLITE_ROW ? SQLITE_CORRUPT : code;
    cursor->n_rows_before = cursor->n_rows;
}

void wb_recording_cursor_close(struct wb_recording_cursor *cursor)
{
    sqlite3_finalize(cursor->statement);
    cursor->statement = NULL;
}
