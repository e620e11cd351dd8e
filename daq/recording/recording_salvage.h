/* Rows of a damaged recording, read from its pages and not through SQLite.
 *
 * SQLite reads a table from its root down and a write-ahead log from its beginning on: behind one
 * bad page or frame nothing is found. Each row of schema 2 says by its checksum that it is a row,
 * of which table, with which number. So every page of the file and every page in the log is looked
 * at by itself, in whatever order they stand, and what fits its checksum counts.
 */
#ifndef WB_DAQ_RECORDING_RECORDING_SALVAGE_H
#define WB_DAQ_RECORDING_RECORDING_SALVAGE_H

#include "daq/recording/recording_private.h"

struct wb_recording_salvage; /* opaque */

/* Finds the rows in the bytes of a recording and of its log (n_log 0: none), both borrowed. Any
 * bytes are taken; the time it takes is that of reading them a few times. */
struct wb_recording_salvage *wb_recording_salvage_find(const uint8_t *file, size_t n_file,
                                                       const uint8_t *log, size_t n_log);
void wb_recording_salvage_destroy(struct wb_recording_salvage *salvage); /* accepts NULL */

/* How many there are, each number once. */
size_t wb_recording_salvage_count(const struct wb_recording_salvage *salvage);

/* The row at an index, in order of their numbers; what it points to is valid until the next call.
 */
void wb_recording_salvage_row(struct wb_recording_salvage *salvage, size_t index,
                              struct wb_recording_row *row);

#endif
