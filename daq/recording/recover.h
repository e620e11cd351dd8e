/* Recovers a damaged or unclosed recording: copies all rows that can be found to a new file. */
#ifndef WB_DAQ_RECORDING_RECOVER_H
#define WB_DAQ_RECORDING_RECOVER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/reason.h"
#include "daq/recording/recording.h"

/* Meta keys of a recovered recording: the damaged file, its SHA-256 (with its log), the program
 * that recovered it, and a description of the missing rows ("" if none). */
#define WB_RECOVER_META_FROM "recovered_from"
#define WB_RECOVER_META_SHA256 "recovered_sha256"
#define WB_RECOVER_META_TOOL "recovered_with"
#define WB_RECOVER_META_MISSING "recovered_missing"

enum {
    WB_RECOVER_STREAMS = 16
};

struct wb_recover_stream {
    uint64_t chunks, missing; /* missing: by gaps in the sequence numbers, which begin at 0 */
    int64_t next;             /* expected sequence number */
};

/* Result of a recovery. */
struct wb_recover {
    char sha256[WB_SHA256_TEXT]; /* of the file and its log */
    bool is_protected;           /* schema 2: every row was checked; schema 1: only chunks' bytes */
    uint64_t rows;
    uint64_t missing; /* rows missing before and between those found; 0 in schema 1 */
    char missing_where[160];
    bool is_end_known;         /* the last row, which closing writes, was found */
    bool is_log_missing;       /* the file was not closed, and has no log */
    uint64_t damaged;          /* schema 1: damaged rows */
    bool is_broken;            /* schema 1: a table could not be read to its end */
    int64_t first_ns, last_ns; /* of the chunks */
    struct wb_recover_stream streams[WB_RECOVER_STREAMS]; /* by stream number */
};

/* Reads `from` (.wbr or .wbr.zst, with its -wal if present) without changing it, and writes and
 * closes the new recording `to`. WB_ERR_EXISTS: `to` exists; WB_ERR_FORMAT: no row of a recording
 * was found. On failure no file is left behind. */
WB_MUST_CHECK enum wb_status wb_recover_run(const char *from, const char *to,
                                            struct wb_recover *found, struct wb_reason *why);

/* Whether all recorded rows were found. */
bool wb_recover_is_whole(const struct wb_recover *found);

/* Describes the missing rows, as clauses separated by "; "; "" if none are missing. */
void wb_recover_missing(const struct wb_recover *found, char *text, size_t size);

#endif
