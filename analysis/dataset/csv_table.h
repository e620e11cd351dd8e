/* Strict CSV tables of a dataset's folder: fields.csv, surface.csv. Comma-separated, no quotes, a
 * header line with the names of the columns, every line with as many fields. Errors name file, line
 * and column. The number functions also serve the dataset's own tables. */
#ifndef WB_ANALYSIS_DATASET_CSV_TABLE_H
#define WB_ANALYSIS_DATASET_CSV_TABLE_H

#include <stdbool.h>

#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

enum {
    WB_CSV_TABLE_MOST = 32 /* columns */
};

struct wb_csv_table {
    const char *path; /* for messages */
    int n_columns;
    const char *const *columns; /* their names */
    int line;                   /* last line read; 0 at first */
    /* Reads the fields of a line. */
    enum wb_status (*take)(void *context, const struct wb_csv_table *table, char *const *fields);
    /* Checks the data after the last line; may be NULL. */
    enum wb_status (*finish)(void *context, const struct wb_csv_table *table);
    void *context;
    struct wb_reason *why; /* receives the reason of a failure; NULL: it is logged */
};

/* Fails with "FILE:LINE: message"; `format` is a literal. A macro, so that the domain of the
 * message is that of the file in which it is used. */
#define wb_csv_table_fail(table, format, ...)                                                      \
    wb_fail_to((table)->why, WB_ERR_FORMAT, "%s:%d: " format, (table)->path, (table)->line,        \
               __VA_ARGS__)

/* For take(): rejects a field, or reads a whole number from 0 to `most`. */
enum wb_status wb_csv_table_refuse(const struct wb_csv_table *table, int column,
                                   const char *expected, const char *text);
WB_MUST_CHECK enum wb_status wb_csv_table_integer(const struct wb_csv_table *table, int column,
                                                  char *const *fields, int most, int *value);

/* --- numbers --- */

/* Bytes of a number as text. */
#define WB_CSV_TABLE_NUMBER 64

/* Files contain millimetres; the decimal point is moved in the text, not in binary, so that every
 * double is read back bit for bit. Appends a double times 10^shift as the shortest decimal text
 * that wb_csv_table_parse_number() turns back into the same double; nothing if it is not finite. */
void wb_csv_table_append_number(struct wb_text *text, double value, int shift);
/* False unless the whole text is one finite decimal number. */
bool wb_csv_table_parse_number(const char *text, int shift, double *value);

/* --- files --- */

/* Cuts the next line off a text, without its end, and counts it; NULL at the end of the text. */
char *wb_csv_table_line(struct wb_csv_table *table, char **text);

/* Reads a table from a folder; a missing file is an empty table. `path` of the table is set during
 * the call. */
WB_MUST_CHECK enum wb_status wb_csv_table_read(struct wb_csv_table *table, const char *folder,
                                               const char *name);

/* Appends the line of the columns' names. */
void wb_csv_table_append_header(struct wb_text *text, const char *const *columns, int n);

/* Writes a table into a folder; NULL text removes the file. */
WB_MUST_CHECK enum wb_status wb_csv_table_write(const char *folder, const char *name,
                                                const struct wb_text *text);

#endif
