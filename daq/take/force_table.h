/* Reads force over time from a text file of a data logger, with any delimiter and encoding
 * (base/text_table.h). */
#ifndef WB_DAQ_TAKE_FORCE_TABLE_H
#define WB_DAQ_TAKE_FORCE_TABLE_H

#include <stddef.h>

#include "base/reason.h"
#include "daq/protocol/rig.h"

struct wb_force_table {
    size_t n;
    double *t;           /* (n) s, ascending; owned */
    double *force;       /* (n) N, multiplied by load_cell.sign of the rig; owned */
    size_t skipped_rows; /* rows without time or force, not in order, or truncated */
    size_t empty_rows;
    int first_skipped; /* line number; 0: none */
};

/* Bytes of a list with both columns. */
#define WB_FORCE_TABLE_LIST 80

/* Reads the table. `list` gives the columns of time and force as for wb_table_columns_find(); "":
 * they are found by the header. *taken receives the used columns with their units, as such a list.
 * `name` is the name of the file in messages. */
WB_MUST_CHECK enum wb_status wb_force_table_parse(struct wb_force_table *table, const char *name,
                                                  const void *bytes, size_t n, const char *list,
                                                  char taken[WB_FORCE_TABLE_LIST],
                                                  const struct wb_rig *rig, struct wb_reason *why);
void wb_force_table_release(struct wb_force_table *table);

#endif
