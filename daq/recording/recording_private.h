/* Between the parts of the recording, recording_*.c. Only these include sqlite3.h, zlib.h and
 * zstd.h.
 */
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

/* A read or datagram has at most 64 KiB; longer blobs are damage. */
#define WB_RECORDING_LONGEST_VALUE (16 << 20)

/* --- the write-ahead log --- */

/* What SQLite reads of a log, and what is in it. */
struct wb_recording_log {
    uint64_t frames;   /* of this run of the log: those of an earlier one may stand behind it */
    uint64_t readable; /* of them, up to the first that does not fit its checksum */
};

/* Looks at the bytes of a log. */
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

/* The columns of a table, and of each its type: i integer, r real, t text, b blob. From schema 2 on
 * the row's number `n` stands before them (SQLite's rowid; it counts the rows of all tables in
 * order of writing, from 1), and behind them `crc32` and `chain`. */
struct wb_recording_table {
    const char *name, *columns, *types;
};
extern const struct wb_recording_table wb_recording_tables[WB_RECORDING_TABLES];

/* The key of the last meta value, which closing writes. */
#define WB_RECORDING_DIGEST "digest"

#define WB_RECORDING_VALUES 5
#define WB_RECORDING_CHUNK_BYTES 3 /* the place of a chunk's bytes among its values */

struct wb_recording_value {
    int64_t integer;
    double real;
    const void *bytes; /* text (not ended) or blob */
    size_t n;
};

struct wb_recording_row {
    enum wb_recording_kind kind;
    int64_t number;                                        /* SQLite's rowid */
    struct wb_recording_value values[WB_RECORDING_VALUES]; /* until the statement goes on */
    int64_t crc32, chain;                                  /* as stored; -1: none */
    bool intact;                                           /* of schema 1: as far as is known */
    bool is_nothing; /* no column has its type: not a row that was written */
};

/* CRC-32 of a row with its number and the name of its table. */
uint32_t wb_recording_row_crc32(enum wb_recording_kind kind, int64_t number,
                                const struct wb_recording_value *values);
/* The chain's value behind a row: CRC-32 of its value before (0 before the first row) and of the
 * row's CRC-32, 4 bytes each, least significant first. */
uint32_t wb_recording_chain(uint32_t before, uint32_t row_crc32);
/* The digest is the SHA-256 of the CRC-32 of all rows before its own, 4 bytes each, least
 * significant first. */
void wb_recording_digest_add(struct wb_hash *digest, uint32_t row_crc32);

/* What to select for wb_recording_read_row(). */
void wb_recording_row_columns(const struct wb_recording *recording, enum wb_recording_kind kind,
                              char *text, size_t size);
void wb_recording_read_row(const struct wb_recording *recording, enum wb_recording_kind kind,
                           sqlite3_stmt *statement, struct wb_recording_row *row);

/* --- reading a table --- */

/* Goes through a table in order of its row numbers and past damaged pages. */
struct wb_recording_cursor {
    struct wb_recording *recording;
    sqlite3_stmt *statement;
    int64_t last, before_last, n_steps, n_rows;
    int code;              /* SQLITE_DONE, or why rows are missing */
    int64_t n_rows_before; /* rows before the first damage */
};

/* `columns` begins with rowid. When this fails, with a message if `tell`, there is nothing to step,
 * and closing is allowed. */
WB_MUST_CHECK enum wb_status wb_recording_cursor_open(struct wb_recording_cursor *cursor,
                                                      struct wb_recording *recording,
                                                      const char *columns, const char *table,
                                                      bool tell);
/* False at the end. */
bool wb_recording_cursor_step(struct wb_recording_cursor *cursor);
/* Notes that rows are missing here. */
void wb_recording_cursor_break(struct wb_recording_cursor *cursor, int code);
void wb_recording_cursor_close(struct wb_recording_cursor *cursor);

/* Visits the rows of all tables, damaged ones too, in order of writing; those of schema 1 table
 * after table. *broken is true when rows cannot be read; everything else has been visited. */
WB_MUST_CHECK enum wb_status
wb_recording_scan(struct wb_recording *recording,
                  enum wb_status (*visit)(void *context, const struct wb_recording_row *row),
                  void *context, bool *broken);

/* --- the recording --- */

struct wb_recording {
    sqlite3 *db;
    char *path;
    struct wb_reason *why; /* of reading; NULL: it is logged */
    bool writing;
    int schema;
    /* Writing. */
    sqlite3_stmt *insert[WB_RECORDING_TABLES];
    bool in_transaction;
    enum wb_status failed;  /* the first error since something was flushed */
    int64_t n_rows;         /* written so far */
    int64_t checkpoint_ns;  /* when what was flushed last went from the log into the file */
    uint32_t chain;         /* behind the last of them, */
    uint32_t flushed_chain; /* and behind the last that was flushed */
    uint32_t *unflushed;    /* (n_unflushed) CRC-32 of the rows since */
    size_t n_unflushed, capacity;
    struct wb_hash *digest;
    /* Reading. */
    bool compressed;  /* .zst: */
    int uncompressed; /* a descriptor of what was decompressed; else -1 */
    bool complete;    /* closed properly */
    bool shortened;   /* the file is shorter than its own header says, or not all decompressed */
    int64_t bytes_there, bytes_expected; /* decompressed; as the file's own header counts them */
    bool is_log_missing;                 /* it was not closed, and there is no log beside it */
    struct wb_recording_log log;         /* beside it */
    const char *told[8];                 /* tables already reported as broken off; */
    size_t n_told;                       /* constants */
    int64_t n_rows_max;                  /* no table of a file of this size can hold more rows */
    /* Both. */
    int n_streams;
    struct wb_recording_stream *streams;
    char **settings; /* of each stream */
};

/* Adds to the list of streams in memory; takes over nothing. */
WB_MUST_CHECK enum wb_status wb_recording_remember_stream(struct wb_recording *recording,
                                                          const struct wb_recording_stream *stream,
                                                          const char *settings);

/* Frees statements, database and memory. */
void wb_recording_release(struct wb_recording *recording);

/* Turns an SQLite code into ours: the one place. `doing` completes "'PATH': cannot ...". */
WB_MUST_CHECK enum wb_status wb_recording_fail(const struct wb_recording *recording, int code,
                                               const char *doing);

/* zlib's CRC-32, that of gzip. */
uint32_t wb_recording_crc32(const void *bytes, size_t n);

/* A new file in the temporary folder ($TMPDIR, else /tmp), open for reading and writing; `path`
 * receives its name, and the caller unlinks it. */
WB_MUST_CHECK enum wb_status wb_recording_temporary(char *path, size_t size, int *descriptor,
                                                    struct wb_reason *why);

/* Appends a row as it stands. */
WB_MUST_CHECK enum wb_status wb_recording_append_row(struct wb_recording *recording,
                                                     enum wb_recording_kind kind,
                                                     const struct wb_recording_value *values);

/* Whether a file's header says that a write-ahead log belongs to it: it was not closed. */
bool wb_recording_needs_log(const uint8_t *file, size_t n);

/* True when the first bytes are those of zstd. */
bool wb_recording_is_zstd(const uint8_t *bytes, size_t n);

/* Decompresses all of `from` into `to`. *whole is false when the compressed data breaks off or is
 * damaged: then what came before it is there. */
WB_MUST_CHECK enum wb_status wb_recording_decompress(int from, int to, const char *path,
                                                     bool *whole, struct wb_reason *why);

/* Compresses a closed recording to `target` (.wbr.zst), written atomically; the same recording and
 * zstd release give the same bytes. WB_ERR_EXISTS when the target exists, WB_ERR_BUSY when the
 * recording was not closed. */
WB_MUST_CHECK enum wb_status wb_recording_compress(const char *path, const char *target);

#endif
