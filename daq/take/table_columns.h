/* Finds the columns of time, force, travel and strain in a table, and their units.
 *
 * They are found by the words of the header ("Load (N)", "Standardkraft [N]", "time_s", or with a
 * line of units below), or given as a list with column numbers from 1, and with units if the header
 * has none: "time=1,force=2:mN,travel=3". If several columns fit equally well, that is an error.
 */
#ifndef WB_DAQ_TAKE_TABLE_COLUMNS_H
#define WB_DAQ_TAKE_TABLE_COLUMNS_H

#include "base/reason.h"
#include "base/text_table.h"

enum wb_measured {
    WB_MEASURED_TIME,
    WB_MEASURED_FORCE,
    WB_MEASURED_TRAVEL, /* of the crosshead or the clamp, or an elongation */
    WB_MEASURED_STRAIN,
    WB_MEASURED_COUNT
};

#define WB_MEASURED_BIT(measured) (1u << (measured))

/* Name in a list of columns: "time", "force", "travel", "strain". */
const char *wb_table_columns_name(enum wb_measured measured);

struct wb_table_columns {
    int column[WB_MEASURED_COUNT]; /* from 0; -1: none */
    char unit[WB_MEASURED_COUNT][16];
    double factor[WB_MEASURED_COUNT]; /* from the file's unit to SI */
};

/* Finds the columns. `list` gives them as above, and then no others are used; NULL or "": by the
 * header. `needed`: set of WB_MEASURED_BIT() that must be found. Units of mass are converted to
 * weights with `gravity`, m/s2. WB_ERR_FORMAT, with a list of the columns: a needed column was not
 * found; WB_ERR_ARGUMENT: the list is wrong. `name` is the name of the file in messages, which are
 * stored in `why`; NULL: they are logged. */
WB_MUST_CHECK enum wb_status wb_table_columns_find(struct wb_table_columns *columns,
                                                   const struct wb_text_table *table,
                                                   const char *list, unsigned needed,
                                                   double gravity, const char *name,
                                                   struct wb_reason *why);

/* Reads a value in SI; *value is NaN if the field is empty or the column is missing. A field that
 * is not a number is an error with line and column. */
WB_MUST_CHECK enum wb_status wb_table_columns_value(const struct wb_table_columns *columns,
                                                    const struct wb_text_table *table, size_t row,
                                                    enum wb_measured measured, double *value,
                                                    const char *name, struct wb_reason *why);

#endif
