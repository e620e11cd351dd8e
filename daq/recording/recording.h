/* Recordings: the raw bytes with their arrival times, in an SQLite database `NAME.wbr`.
 *
 * Tables (schema 2): meta(key, value), stream(id, role, address, protocol, settings),
 * chunk(stream, seq, t_ns, bytes), event(t_ns, kind, text),
 * clock(stream, t_host_ns, t_device, rtt_ns). Each row also has n, its number in order of writing
 * over all tables; crc32, the checksum of its contents; and chain, a checksum over the crc32 of all
 * rows up to it. The last row is a SHA-256 over all rows. Schema 1 has a crc32 of the bytes of
 * chunks only. docs/file-formats.md has the details. application_id is 0x57425231 ("WBR1"),
 * user_version is the schema. WAL is used while recording; closing checkpoints and sets
 * journal_mode=DELETE, so that a closed file can be read from a read-only folder.
 * `.wbr.zst` is the same file compressed with zstd; both can be opened.
 *
 * Closing sets meta 'closed' to the UTC time; if it is missing, the recording was ended by a crash,
 * a power cut or a full disk. Only recording_*.c include sqlite3.h, zlib.h and zstd.h.
 */
#ifndef WB_DAQ_RECORDING_RECORDING_H
#define WB_DAQ_RECORDING_RECORDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"
#include "daq/protocol/driver.h"

#define WB_RECORDING_SCHEMA 2

struct wb_recording; /* opaque; used by one thread */

/* --- writing --- */

/* Creates a new recording; WB_ERR_EXISTS if the path exists (a recording is never overwritten). */
WB_MUST_CHECK enum wb_status wb_recording_create(struct wb_recording **out, const char *path);

/* Sets a meta value (text). If a key is set again, the last value is valid. */
WB_MUST_CHECK enum wb_status wb_recording_set_meta(struct wb_recording *recording, const char *key,
                                                   const char *value);

/* Declares a stream (texts are truncated to the sizes of struct wb_recording_stream); *id receives
 * its number (0, 1, ...). */
WB_MUST_CHECK enum wb_status wb_recording_add_stream(struct wb_recording *recording,
                                                     enum wb_role role, const char *address,
                                                     const char *protocol, const char *settings,
                                                     int *id);

/* Appends one read or datagram unchanged. Appends form a transaction until wb_recording_flush()
 * (the caller flushes every 100 ms). WB_ERR_IO: the disk is full or fails; flushed data stay
 * readable. */
WB_MUST_CHECK enum wb_status wb_recording_append_chunk(struct wb_recording *recording, int stream,
                                                       int64_t seq, int64_t t_ns, const void *bytes,
                                                       size_t n);
WB_MUST_CHECK enum wb_status wb_recording_append_event(struct wb_recording *recording, int64_t t_ns,
                                                       const char *kind, const char *text);
WB_MUST_CHECK enum wb_status wb_recording_append_clock(struct wb_recording *recording, int stream,
                                                       int64_t t_host_ns, double t_device,
                                                       int64_t rtt_ns);
/* Commits the appended rows. If an append or a flush fails, all rows since the last successful
 * flush are discarded, and the caller appends them again or gives up; appending continues after the
 * last flushed row, so that recording can resume when the disk recovers. Only the first failure is
 * logged until a flush succeeds. A recording whose last flush failed is not closed properly. */
WB_MUST_CHECK enum wb_status wb_recording_flush(struct wb_recording *recording);

/* Flushes and checkpoints to a single file, and frees. A recording opened for reading is only
 * freed. Accepts NULL. */
WB_MUST_CHECK enum wb_status wb_recording_close(struct wb_recording *recording);

/* --- reading --- */

/* Opens for reading; a `.zst` is decompressed into an unlinked temporary file. A file that is not a
 * recording or has a newer schema is rejected with the reason. A truncated or damaged database is
 * opened as far as SQLite can read it. */
WB_MUST_CHECK enum wb_status wb_recording_open(struct wb_recording **out, const char *path);
/* The same without the warning about a truncated file. `why` receives the reasons why opening fails
 * and, while the recording is open, why reading fails (one per damaged table, separated by "; ");
 * NULL: they are logged. */
WB_MUST_CHECK enum wb_status wb_recording_open_with_reason(struct wb_recording **out,
                                                           const char *path, struct wb_reason *why);
/* Logs a warning if the file is truncated or its write-ahead log is missing or damaged. */
void wb_recording_warn_cut_short(const struct wb_recording *recording);
/* True if the file is shorter than its header says. Reading tables of such a file fails with
 * WB_ERR_DATA without a message, because the warning was given on opening. In other files each
 * damaged table is reported once. */
bool wb_recording_is_cut_short(const struct wb_recording *recording);

/* Describes a problem of the write-ahead log (`-wal`) of a recording that was not closed: it is
 * missing, or damaged and only partly read. False: no problem. The text needs 240 bytes. */
bool wb_recording_log_problem(const struct wb_recording *recording, char *text, size_t size);

/* False if the recording was not closed properly (crash, full disk) or the file is truncated. */
bool wb_recording_is_complete(const struct wb_recording *recording);

/* Value of a meta key as an allocated string (caller frees); WB_ERR_NOT_FOUND, without a message,
 * if the key is missing. */
WB_MUST_CHECK enum wb_status wb_recording_meta(struct wb_recording *recording, const char *key,
                                               char **value);

/* The bytes of one instrument. */
struct wb_recording_stream {
    int id;
    enum wb_role role;
    char address[160];
    char protocol[32];
};

int wb_recording_n_streams(const struct wb_recording *recording);
const struct wb_recording_stream *wb_recording_stream_at(const struct wb_recording *recording,
                                                         int index);
/* Settings text of the stream's declaration; "" if it has none. */
const char *wb_recording_stream_settings(const struct wb_recording *recording, int index);

/* One read of a port, or one datagram. */
struct wb_chunk {
    int stream;
    int64_t seq, t_ns;
    const uint8_t *bytes; /* valid until the next call */
    size_t n;
    bool intact; /* the checksum matches; if not, no member is reliable (in schema 1 only the bytes
                    are checked) */
};

/* An event as text: a step of the test, a remark on an instrument, a mark. */
struct wb_event {
    int64_t t_ns;
    char kind[32];
    char text[1024];
};

/* One probe of a device's clock: its reading at the middle of the round trip. */
struct wb_clock_row {
    int stream;
    int64_t t_host_ns;
    double t_device;
    int64_t rtt_ns;
};

/* Result of wb_recording_check(). The `_where` members are lists such as "row 12 (meta 'rig'), row
 * 700 (stream 1, chunk 33), ...". */
struct wb_recording_check {
    bool is_protected;     /* schema 2: all contents have checksums */
    bool is_broken;        /* the database itself is damaged */
    bool is_closed;        /* the last row, the digest, exists */
    bool digest_fits;      /* the digest matches the rows */
    uint64_t rows;         /* rows that could be read */
    uint64_t damaged;      /* rows with a wrong checksum */
    uint64_t lost;         /* missing rows, except at the end */
    uint64_t displaced;    /* rows whose chain does not continue that of the row before */
    uint64_t after_digest; /* rows after the digest */
    char damaged_where[160], lost_where[160], displaced_where[160];
};

/* Reads every row and checks its checksum, its number, the chain and the digest. In schema 1 only
 * the bytes of chunks can be checked. */
WB_MUST_CHECK enum wb_status wb_recording_check(struct wb_recording *recording,
                                                struct wb_recording_check *check);

/* Visit all chunks in order of arrival (t_ns, then stream, then seq; ties in order of writing), all
 * events, or all clock rows in order of time. Damaged chunks are visited with `intact` false; other
 * damaged rows are skipped as if they could not be read. If a visitor returns another status than
 * WB_OK, the walk ends and returns it. WB_ERR_DATA, with a message: some rows cannot be read; all
 * others have been visited. */
WB_MUST_CHECK enum wb_status
wb_recording_each_chunk(struct wb_recording *recording,
                        enum wb_status (*visit)(void *context, const struct wb_chunk *chunk),
                        void *context);
WB_MUST_CHECK enum wb_status
wb_recording_each_event(struct wb_recording *recording,
                        enum wb_status (*visit)(void *context, const struct wb_event *event),
                        void *context);
WB_MUST_CHECK enum wb_status
wb_recording_each_clock(struct wb_recording *recording,
                        enum wb_status (*visit)(void *context, const struct wb_clock_row *row),
                        void *context);
/* Visits all meta keys in alphabetical order. */
WB_MUST_CHECK enum wb_status
wb_recording_each_meta(struct wb_recording *recording,
                       enum wb_status (*visit)(void *context, const char *key, const char *value),
                       void *context);

/* The same as wb_recording_sha256() for a recording that is open for reading, without decompressing
 * it again. The reason of a failure is stored in the `why` of wb_recording_open_with_reason(). */
WB_MUST_CHECK enum wb_status wb_recording_hash(const struct wb_recording *recording, char hex[65]);

/* SHA-256 of the uncompressed database as lower-case hex, 64 characters and a NUL. If the recording
 * was not closed: of the file followed by its write-ahead log (`-wal`). If a compressed file is
 * truncated: of the part that can be decompressed. `why` receives the reason of a failure; NULL: it
 * is logged. */
WB_MUST_CHECK enum wb_status wb_recording_sha256(const char *path, char hex[65],
                                                 struct wb_reason *why);

#endif
