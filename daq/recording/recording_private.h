/* Declarations shared by recording_*.c. Only these files include sqlite3.h, zlib.h and zstd.h. */
#ifndef WB_DAQ_RECORDING_RECORDING_PRIVATE_H
#define WB_DAQ_RECORDING_RECORDING_PRIVATE_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/hash.h"
#include "daq/recording/recording.h"

/* "WBR1" */
#define WB_RECORDING_APPLICATION_ID 0x57425231

/* A read or datagram has at most 64 KiB and texts are shorter than this; longer values are damage.
 */
#define WB_RECORDING_LONGEST_VALUE (16 << 20)

/* A number in the header of a file or of its log. */
static inline uint32_t wb_recording_big_endian(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* --- the write-ahead log --- */

/* Frames of a write-ahead log. */
struct wb_recording_log {
    uint64_t frames;   /* of the current log; frames of an older one may follow in the file */
    uint64_t readable; /* frames before the first with a wrong checksum, which SQLite reads */
};

/* Counts the frames in the bytes of a log. */
void wb_recording_log_count(const uint8_t *bytes, size_t n, struct wb_recording_log *log);

/* --- rows --- */

enum wb_recording_kind {
    WB_RECORDING_META,
    WB_RECORDING_STREAM,
    WB_RECORDING_CHUNK,
    WB_RECORDING_EVENT,
    WB_RECORDING_CLOCK,
    WB_RECORDING_TABLES
};

/* The columns of a table with their types: i integer, r real, t text, b blob. From schema 2 on they
 * are preceded by the row's number `n` (SQLite's rowid; it counts the rows of all tables in order
 * of writing, from 1), and followed by `crc32` and `chain`. */
struct wb_recording_table {
    const char *name, *columns, *types;
};
extern const struct wb_recording_table wb_recording_tables[WB_RECORDING_TABLES];

/* Key of the last meta value, which is written on closing. */
#define WB_RECORDING_DIGEST "digest"

#define WB_RECORDING_VALUES 5
#define WB_RECORDING_CHUNK_BYTES 3 /* index of a chunk's bytes among its values */

struct wb_recording_value {
    int64_t integer;
    double real;
    const void *bytes; /* text (without NUL) or blob */
    size_t n;
};

struct wb_recording_row {
    enum wb_recording_kind kind;
    int64_t number;                                        /* SQLite's rowid */
    struct wb_recording_value values[WB_RECORDING_VALUES]; /* valid until the next step */
    int64_t crc32, chain;                                  /* as stored; -1: none */
    bool intact;                                           /* schema 1: as far as can be checked */
    bool is_nothing; /* no column has its type: this row was never written */
};

/* CRC-32 of a row with its number and the name of its table. */
uint32_t wb_recording_row_crc32(enum wb_recording_kind kind, int64_t number,
                                const struct wb_recording_value *values);
/* Value of the chain after a row: CRC-32 of its value before (0 before the first row) and of the
 * row's CRC-32, 4 bytes each, least significant first. */
uint32_t wb_recording_chain(uint32_t before, uint32_t row_crc32);
/* The digest is the SHA-256 of the CRC-32 of all rows before its own, 4 bytes each, least
 * significant first. */
void wb_recording_digest_add(struct wb_hash *digest, uint32_t row_crc32);

struct wb_recording_cursor;
/* Reads the row at a cursor over whole rows. */
void wb_recording_read_row(const struct wb_recording_cursor *cursor, struct wb_recording_row *row);

/* --- reading a table --- */

/* Iterates over a table in order of row numbers and skips damaged pages. */
struct wb_recording_cursor {
    struct wb_recording *recording;
    enum wb_recording_kind kind;
    sqlite3_stmt *statement;
    int64_t last, before_last, n_steps, n_rows;
    int code;              /* SQLITE_DONE, or the cause of missing rows */
    int64_t n_rows_before; /* rows before the first damage */
};

/* `columns` must begin with rowid; NULL: those of wb_recording_read_row(). Logs a failure if
 * `report`; the cursor then has no rows and may be closed. */
WB_MUST_CHECK enum wb_status wb_recording_cursor_open(struct wb_recording_cursor *cursor,
                                                      struct wb_recording *recording,
                                                      enum wb_recording_kind kind,
                                                      const char *columns, bool report);
/* False at the end. */
bool wb_recording_cursor_step(struct wb_recording_cursor *cursor);
/* Records that rows are missing at this point. */
void wb_recording_cursor_break(struct wb_recording_cursor *cursor, int code);
void wb_recording_cursor_close(struct wb_recording_cursor *cursor);

/* Visits the rows of all tables, including damaged ones, in order of writing (schema 1: table by
 * table). *broken: some rows cannot be read; all others have been visited. */
WB_MUST_CHECK enum wb_status
wb_recording_scan(struct wb_recording *recording,
                  enum wb_status (*visit)(void *context, const struct wb_recording_row *row),
                  void *context, bool *broken);

/* Appends to a list of places, or "..." once the list is full. */
void wb_recording_add_place(char *places, size_t size, const char *place);

/* --- the recording --- */

struct wb_recording {
    sqlite3 *db;
    char *path;
    struct wb_reason *why; /* receives errors of reading; NULL: they are logged */
    bool writing;
    int schema;
    /* Writing. */
    sqlite3_stmt *insert[WB_RECORDING_TABLES];
    bool in_transaction;
    enum wb_status failed;  /* the first error since the last successful flush */
    int64_t n_rows;         /* rows appended so far */
    int64_t checkpoint_ns;  /* time of the last checkpoint of the log into the file */
    uint32_t chain;         /* after the last appended row */
    uint32_t flushed_chain; /* after the last flushed row */
    uint32_t *unflushed;    /* (n_unflushed) CRC-32 of the rows since the last flush */
    size_t n_unflushed, capacity;
    struct wb_hash *digest;
    /* Reading. */
    bool compressed;  /* a .zst file */
    int uncompressed; /* descriptor of the decompressed file; -1: not compressed */
    bool complete;    /* closed properly */
    bool shortened;   /* shorter than its header says, or not completely decompressed */
    int64_t bytes_there, bytes_expected;   /* size of the database; size by its header */
    bool is_log_missing;                   /* not closed, and without a write-ahead log */
    struct wb_recording_log log;           /* the write-ahead log */
    bool is_reported[WB_RECORDING_TABLES]; /* tables that were reported as damaged */
    int64_t n_rows_max; /* upper bound of the rows of a table in a file of this size */
    /* Reading and writing. */
    int n_streams;
    struct wb_recording_stream *streams;
    char **settings; /* of each stream */
};

/* Adds a stream to the list in memory; all texts are copied. */
WB_MUST_CHECK enum wb_status wb_recording_remember_stream(struct wb_recording *recording,
                                                          const struct wb_recording_stream *stream,
                                                          const char *settings);

/* Frees statements, database and memory. */
void wb_recording_release(struct wb_recording *recording);

/* Maps a code of SQLite to a status and message. `doing` completes "'PATH': cannot ...". */
WB_MUST_CHECK enum wb_status wb_recording_fail(const struct wb_recording *recording, int code,
                                               const char *doing);

/* CRC-32 as in zlib and gzip. */
uint32_t wb_recording_crc32(const void *bytes, size_t n);

/* Creates a file in the temporary folder ($TMPDIR or /tmp), open for reading and writing; `path`
 * receives its name; the caller unlinks it. */
WB_MUST_CHECK enum wb_status wb_recording_temporary(char *path, size_t size, int *descriptor,
                                                    struct wb_reason *why);

/* Appends a row of any table. */
WB_MUST_CHECK enum wb_status wb_recording_append_row(struct wb_recording *recording,
                                                     enum wb_recording_kind kind,
                                                     const struct wb_recording_value *values);

/* Whether the header of a file requires a write-ahead log, because it was not closed. */
bool wb_recording_needs_log(const uint8_t *file, size_t n);

/* Whether the first bytes are those of zstd. */
bool wb_recording_is_zstd(const uint8_t *bytes, size_t n);

/* Decompresses `from` into `to`. *whole is false if the compressed data are truncated or damaged;
 * the data before that are written. */
WB_MUST_CHECK enum wb_status wb_recording_decompress(int from, int to, const char *path,
                                                     bool *whole, struct wb_reason *why);

#endif
