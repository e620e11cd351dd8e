#include "daq/take/force_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "daq/take/table_columns.h"

#define WB_LOG_DOMAIN "force"

#define LARGEST_TIME 1e8 /* s */

static enum wb_status read_rows(struct wb_force_table *out, const struct wb_text_table *table,
                                const char *name, const struct wb_table_columns *columns, int sign,
                                struct wb_reason *why)
{
    /* Without a line end the last row may be truncated within a number. */
    const size_t n_rows = table->n_rows - (table->ends_without_end && table->n_rows > 0);
    for (size_t i = 0; i < table->n_rows; i++) {
        double t = (double)NAN, force = (double)NAN;
        if (i < n_rows) {
            WB_TRY(wb_table_columns_value(columns, table, i, WB_MEASURED_TIME, &t, name, why));
            WB_TRY(wb_table_columns_value(columns, table, i, WB_MEASURED_FORCE, &force, name, why));
        }
        if (fabs(t) >= LARGEST_TIME)
            return wb_text_table_reject(table, name, i, columns->column[WB_MEASURED_TIME],
                                        "expected a time in seconds since the start of a test",
                                        why);
        if (isfinite(t) && isfinite(force) && (out->n == 0 || t > out->t[out->n - 1])) {
            out->t[out->n] = t;
            out->force[out->n++] = sign * force;
        } else {
            out->skipped_rows++;
            if (!out->first_skipped)
                out->first_skipped = table->lines[i];
        }
    }
    out->empty_rows = table->n_empty_lines;
    if (out->n < 2 || out->skipped_rows > out->n)
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s:%d: column %d: only %zu of %zu rows have a force and an ascending "
                          "time; this is the first row without",
                          name, out->first_skipped ? out->first_skipped : 1,
                          columns->column[WB_MEASURED_TIME] + 1, out->n, table->n_rows);
    return WB_OK;
}

static enum wb_status take(struct wb_force_table *out, const struct wb_text_table *table,
                           const char *name, const char *list, char *taken,
                           const struct wb_rig *rig, struct wb_reason *why)
{
    struct wb_table_columns columns;
    const unsigned needed = WB_MEASURED_BIT(WB_MEASURED_TIME) | WB_MEASURED_BIT(WB_MEASURED_FORCE);
    WB_TRY(wb_table_columns_find(&columns, table, list, needed, rig->gravity, name, why));
    snprintf(taken, WB_FORCE_TABLE_LIST, "time=%d:%s,force=%d:%s",
             columns.column[WB_MEASURED_TIME] + 1, columns.unit[WB_MEASURED_TIME],
             columns.column[WB_MEASURED_FORCE] + 1, columns.unit[WB_MEASURED_FORCE]);
    return read_rows(out, table, name, &columns, rig->load_cell.sign, why);
}

enum wb_status wb_force_table_parse(struct wb_force_table *out, const char *name, const void *bytes,
                                    size_t n, const char *list, char taken[WB_FORCE_TABLE_LIST],
                                    const struct wb_rig *rig, struct wb_reason *why)
{
    struct wb_text_table table;
    memset(out, 0, sizeof *out);
    taken[0] = '\0';
    WB_TRY(wb_text_table_parse(&table, bytes, n, name, NULL, why));
    out->t = wb_memory_new(table.n_rows, sizeof *out->t);
    out->force = wb_memory_new(table.n_rows, sizeof *out->force);
    const enum wb_status status = take(out, &table, name, list, taken, rig, why);
    wb_text_table_release(&table);
    if (status != WB_OK)
        wb_force_table_release(out);
    return status;
}

void wb_force_table_release(struct wb_force_table *table)
{
    free(table->t);
    free(table->force);
    memset(table, 0, sizeof *table);
}
