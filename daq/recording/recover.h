/* A damaged or unclosed recording made whole: all rows that can still be found, in a new file. */
#ifndef WB_DAQ_RECORDING_RECOVER_H
#define WB_DAQ_RECORDING_RECOVER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/reason.h"
#include "daq/recording/recording.h"

/* Meta keys of a recording that was recovered: the file it came from, that file's SHA-256 (with its
 * log), what brought it back, and what is missing, in words; "" when nothing is. */
#define WB_RECOVER_META_FROM "recovered_from"
#define WB_RECOVER_META_SHA256 "recovered_sha256"
#define WB_RECOVER_META_TOOL "recovered_with"
#define WB_RECOVER_META_MISSING "recovered_missing"

enum {
    WB_RECOVER_STREAMS = 16
};

struct wb_recover_stream {
    uint64_t chunks, missing; /* by their sequence numbers, which count from 0 */
    int64_t next;             /* sequence number */
};

/* What was found. */
struct wb_recover {
    char sha256[WB_SHA256_TEXT]; /* of the file and its log */
    bool is_protected;           /* schema 2: every row was checked; else the chunks' bytes alone */
    uint64_t rows;
    uint64_t missing; /* rows between those that are there, and before them; 0 in schema 1 */
    char missing_where[160];
    bool is_end_known;         /* the last row, which closing writes, is there */
    bool is_log_missing;       /* the file was not closed, and has no log */
    uint64_t damaged;          /* schema 1: rows that are as they are no more */
    bool is_broken;            /* schema 1: a table could not be read to its end */
    int64_t first_ns, last_ns; /* of the chunks */
    struct wb_recover_stream streams[WB_RECOVER_STREAMS]; /* by their number */
};

/* Reads `from` (.wbr or .wbr.zst, with its -wal where there is one) without touching it and writes
 * the new recording `to`, closed. WB_ERR_EXISTS when `to` exists, WB_ERR_FORMAT when no row of a
 * recording is found; nothing is left behind then. */
WB_MUST_CHECK enum wb_status wb_recover_run(const char *from, const char *to,
                                            struct wb_recover *found, struct wb_reason *why);

/* Everything that was recorded is there. */
bool wb_recover_is_whole(const struct wb_recover *found);

/* What is missing, in words, one clause after the other; "" when nothing is. */
void wb_recover_missing(const struct wb_recover *found, char *text, size_t size);

#endif
