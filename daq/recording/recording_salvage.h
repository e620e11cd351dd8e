/* Reads the rows of a damaged recording from its pages, without SQLite.
 *
 * SQLite reads a table from its root and a write-ahead log from its beginning, and finds nothing
 * after one damaged page or frame. The checksum of a row of schema 2 covers the name of its table
 * and its number. Therefore every page of the file and of the log is scanned independently, and
 * rows with a correct checksum are accepted.
 */
#ifndef WB_DAQ_RECORDING_RECORDING_SALVAGE_H
#define WB_DAQ_RECORDING_RECORDING_SALVAGE_H

#include "daq/recording/recording_private.h"

struct wb_recording_salvage; /* opaque */

/* Finds the rows in the bytes of a recording and of its log (n_log 0: none), both borrowed. Accepts
 * any bytes; the run time is that of reading them a few times. */
struct wb_recording_salvage *wb_recording_salvage_find(const uint8_t *file, size_t n_file,
                                                       const uint8_t *log, size_t n_log);
void wb_recording_salvage_destroy(struct wb_recording_salvage *salvage); /* accepts NULL */

/* Number of rows found; each row number counts once. */
size_t wb_recording_salvage_count(const struct wb_recording_salvage *salvage);

/* The row at an index, in order of row numbers; its values are valid until the next call. */
void wb_recording_salvage_row(struct wb_recording_salvage *salvage, size_t index,
                              struct wb_recording_row *row);

#endif
