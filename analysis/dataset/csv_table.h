/* Strict CSV tables beside a dataset's own: fields.csv, surface.csv. Comma-separated, no quotes, a
 * header line with the columns' names, every line with as many fields. Errors name file, line and
 * column. The numbers serve the dataset's own tables as well.
 */
#ifndef WB_ANALYSIS_DATASET_CSV_TABLE_H
#define WB_ANALYSIS_DATASET_CSV_TABLE_H

#include <stdbool.h>
#include <stddef.h>

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
    int line;                   /* that was read last; 0 at first */
    /* Takes the fields of the next line. */
    enum wb_status (*take)(void *context, const struct wb_csv_table *table, char *const *fields);
    /* Checks what was taken, after the last line. NULL: nothing is to be checked. */
    enum wb_status (*finish)(void *context, const struct wb_csv_table *table);
    void *context;
    struct wb_reason *why; /* why reading failed is written here; NULL: it is logged */
};

/* For take(): refuses a field, or reads a whole number from 0 to `most`. */
enum wb_status wb_csv_table_refuse(const struct wb_csv_table *table, int column,
                                   const char *expected, const char *text);
WB_MUST_CHECK enum wb_status wb_csv_table_integer(const struct wb_csv_table *table, int column,
                                                  char *const *fields, int most, int *value);

/* --- numbers --- */

/* Lengths stand in millimetres; the decimal point is moved in the text, not in binary, so that
 * every double comes back bit for bit: a finite double times 10^shift as the shortest decimal text
 * that wb_csv_table_parse_number() turns back into the same double; `text` needs
 * WB_CSV_TABLE_NUMBER bytes. */
#define WB_CSV_TABLE_NUMBER 64
void wb_csv_table_format_number(double value, int shift, char *text);
/* False when the whole text is not one finite decimal number. */
bool wb_csv_table_parse_number(const char *text, int shift, double *value);

/* --- files --- */

/* Reads a folder's table, whose path the table has meanwhile; nothing where there is no such file.
 */
WB_MUST_CHECK enum wb_status wb_csv_table_read(struct wb_csv_table *table, const char *folder,
                                               const char *name);

/* Appends the line of the columns' names. */
void wb_csv_table_append_header(struct wb_text *text, const char *const *columns, int n);

/* Writes the text of a folder's table, or removes the file when there is none (NULL). */
WB_MUST_CHECK enum wb_status wb_csv_table_write(const char *folder, const char *name,
                                                const struct wb_text *text);

#endif
