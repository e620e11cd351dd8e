/* Which columns of a table hold time, force, travel and strain, and in which units.
 *
 * By themselves they are found by the words of the header ("Load (N)", "Standardkraft [N]",
 * "time_s", or with a line of units below); or they are named, columns counted from 1, units where
 * the header has none: "time=1,force=2:mN,travel=3". What fits several columns equally well is
 * refused.
 */
#ifndef WB_DAQ_TAKE_TABLE_COLUMNS_H
#define WB_DAQ_TAKE_TABLE_COLUMNS_H

#include "base/reason.h"
#include "base/text_table.h"

enum wb_measured {
    WB_MEASURED_TIME,
    WB_MEASURED_FORCE,
    WB_MEASURED_TRAVEL, /* of the machine or the clamp, or an elongation */
    WB_MEASURED_STRAIN,
    WB_MEASURED_COUNT
};

#define WB_MEASURED_BIT(measured) (1u << (measured))

/* "time", "force", "travel", "strain": as in a list of columns. */
const char *wb_table_columns_name(enum wb_measured measured);

struct wb_table_columns {
    int column[WB_MEASURED_COUNT]; /* from 0; -1: none */
    char unit[WB_MEASURED_COUNT][16];
    double factor[WB_MEASURED_COUNT]; /* value in the file to SI */
};

/* Finds the columns. `list` names them as above; NULL or "": by the header. Where a list is given,
 * only what it names is taken. `needed` is made of WB_MEASURED_BIT()s: those that must be there.
 * Units of mass are weights under `gravity`, m/s2. WB_ERR_FORMAT, with the columns that there are,
 * where they cannot be found; WB_ERR_ARGUMENT where the list is wrong. `name` stands for the file
 * in messages, which go to `why`, or to the log where that is NULL. */
WB_MUST_CHECK enum wb_status wb_table_columns_find(struct wb_table_columns *columns,
                                                   const struct wb_text_table *table,
                                                   const char *list, unsigned needed,
                                                   double gravity, const char *name,
                                                   struct wb_reason *why);

/* A value in SI; *value is NaN where the field is empty or there is no such column. A text is
 * refused with its line and column. */
WB_MUST_CHECK enum wb_status wb_table_columns_value(const struct wb_table_columns *columns,
                                                    const struct wb_text_table *table, size_t row,
                                                    enum wb_measured measured, double *value,
                                                    const char *name, struct wb_reason *why);

#endif
