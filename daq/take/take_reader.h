/* The readers of takes, one per file format. To add one, write a file with its struct and add a
 * line to the table of take_reader.c. */
#ifndef WB_DAQ_TAKE_TAKE_READER_H
#define WB_DAQ_TAKE_TAKE_READER_H

#include "daq/take/take.h"

/* A reader. The argument `name` of `read` is the name of the file in messages. On failure
 * (WB_ERR_FORMAT: the file is invalid; WB_ERR_MEMORY) the take is empty. */
struct wb_take_reader {
    const char *name; /* "motive-csv", "c3d", "trc" */
    bool (*is)(const uint8_t *bytes, size_t n);
    enum wb_status (*read)(struct wb_take *take, const char *name, const uint8_t *bytes, size_t n,
                           struct wb_reason *why);
};
extern const struct wb_take_reader wb_motive_csv, wb_c3d, wb_trc;

/* The reader with this name; NULL: none. */
const struct wb_take_reader *wb_take_reader_find(const char *name);

/* The reader for a file with these bytes; NULL: not a take. */
const struct wb_take_reader *wb_take_reader_detect(const uint8_t *bytes, size_t n);

/* Reads a take with the reader that its bytes select, independent of the file name. *reader
 * receives the reader; NULL: not needed. */
WB_MUST_CHECK enum wb_status wb_take_read(struct wb_take *take, const char *name,
                                          const uint8_t *bytes, size_t n,
                                          const struct wb_take_reader **reader,
                                          struct wb_reason *why);
#endif
