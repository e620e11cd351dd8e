/* The readers of takes, one for each format of files. A new one is a file with its struct, and a
 * line in the table of take_reader.c. */
#ifndef WB_DAQ_TAKE_TAKE_READER_H
#define WB_DAQ_TAKE_TAKE_READER_H

#include "daq/take/take.h"

/* One reader. `name` is the file's, for messages. On failure the take is empty. WB_ERR_FORMAT: not
 * understood; WB_ERR_MEMORY. */
struct wb_take_reader {
    const char *name; /* "motive-csv", "c3d", "trc" */
    bool (*is)(const uint8_t *bytes, size_t n);
    enum wb_status (*read)(struct wb_take *take, const char *name, const uint8_t *bytes, size_t n,
                           struct wb_reason *why);
};
extern const struct wb_take_reader wb_motive_csv, wb_c3d, wb_trc;

/* The reader of that name; NULL: none. */
const struct wb_take_reader *wb_take_reader_find(const char *name);

/* The reader of a file with these bytes; NULL: it is no take. */
const struct wb_take_reader *wb_take_reader_detect(const uint8_t *bytes, size_t n);

/* Finds the reader by the bytes, never by the file's name. *reader may be NULL; receives it. */
WB_MUST_CHECK enum wb_status wb_take_read(struct wb_take *take, const char *name,
                                          const uint8_t *bytes, size_t n,
                                          const struct wb_take_reader **reader,
                                          struct wb_reason *why);
#endif
