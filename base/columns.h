/* Tables in memory as columns of one type each, for results of the library and HDF5 files.
 *
 *     static const struct wb_column_kind kinds[] = {{"t_s", "s", WB_COLUMN_REAL}, ...};
 *     wb_columns_init(&table, "load", kinds, 3);
 *     wb_columns_add_row(&table, (union wb_cell[]){{.real = 0.1}, ...});
 *
 * Values are SI; a name ends in its unit.
 */
#ifndef WB_BASE_COLUMNS_H
#define WB_BASE_COLUMNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum wb_column_type {
    WB_COLUMN_REAL,
    WB_COLUMN_INTEGER,
    WB_COLUMN_TEXT
};

struct wb_column_kind {
    const char *name; /* "force_N" */
    const char *unit; /* "N"; "1" for counts and flags; "" for text */
    enum wb_column_type type;
};

struct wb_column {
    const struct wb_column_kind *kind;
    union {
        double *reals;     /* NaN: no value */
        int64_t *integers; /* flags are 0 and 1 */
        char **texts;
    };
};

union wb_cell {
    double real;
    int64_t integer;
    const char *text; /* copied */
};

enum {
    WB_COLUMNS_MOST = 16
};

struct wb_columns {
    const char *name; /* borrowed, like the kinds */
    int n;            /* number of columns, 1..WB_COLUMNS_MOST */
    size_t n_rows, capacity;
    struct wb_column items[WB_COLUMNS_MOST];
};

/* An empty table. */
void wb_columns_init(struct wb_columns *table, const char *name, const struct wb_column_kind *kinds,
                     int n);

/* Appends a row with one cell per column. */
void wb_columns_add_row(struct wb_columns *table, const union wb_cell *cells);

/* The column with that name; NULL if there is none. */
const struct wb_column *wb_columns_find(const struct wb_columns *table, const char *name);

void wb_columns_release(struct wb_columns *table); /* accepts a zeroed one */

#endif
