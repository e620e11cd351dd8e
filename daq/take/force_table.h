/* Force over time from a text file of a data logger, of any delimiter and encoding
 * (base/text_table.h). */
#ifndef WB_DAQ_TAKE_FORCE_TABLE_H
#define WB_DAQ_TAKE_FORCE_TABLE_H

#include <stddef.h>

#include "base/reason.h"
#include "daq/protocol/rig.h"

struct wb_force_table {
    size_t n;
    double *t;           /* (n) s, ascending; owned */
    double *force;       /* (n) N, as the rig's instrument would say: times its sign; owned */
    size_t skipped_rows; /* without time or force, not in order, or cut off */
    size_t empty_rows;
    int first_skipped; /* line; 0: none */
};

/* Bytes of a list of both columns. */
#define WB_FORCE_TABLE_LIST 80

/* Reads the table. `list` names the columns of time and force as wb_table_columns_find() takes it;
 * "": by the header. *taken receives those that were taken, with their units: the same list again.
 * `name` is the file in messages. */
WB_MUST_CHECK enum wb_status wb_force_table_parse(struct wb_force_table *table, const char *name,
                                                  const void *bytes, size_t n, const char *list,
                                                  char taken[WB_FORCE_TABLE_LIST],
                                                  const struct wb_rig *rig, struct wb_reason *why);
void wb_force_table_release(struct wb_force_table *table);

#endif
