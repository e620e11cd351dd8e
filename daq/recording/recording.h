/* Recordings: the raw bytes with their arrival times, in an SQLite database `NAME.wbr`.
 *
 * Tables (schema 2): meta(key, value), stream(id, role, address, protocol, settings),
 * chunk(stream, seq, t_ns, bytes), event(t_ns, kind, text),
 * clock(stream, t_host_ns, t_device, rtt_ns); each row also has n, its number in order of writing
 * over all tables, crc32, of all that the row says, and chain, of the crc32 of all rows up to it.
 * The last row is a SHA-256 over all rows. Schema 1 has crc32 for the bytes of chunks alone.
 * docs/file-formats.md has the details. application_id is 0x57425231 ("WBR1"),
 * user_version is the schema. WAL while recording; closing checkpoints and sets
 * journal_mode=DELETE, so that a finished file can be read from a read-only folder.
 * `.wbr.zst` is the same file compressed with zstd; opening takes both.
 *
 * Closing sets meta 'closed' to the UTC time; without it the recording ended by a crash, a power
 * cut or a full disk. Only recording_*.c include sqlite3.h, zlib.h and zstd.h.
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

/* Sets one meta value (text). The key may be set again: the last value counts. */
WB_MUST_CHECK enum wb_status wb_recording_set_meta(struct wb_recording *recording, const char *key,
                                                   const char *value);

/* Declares a stream (texts are cut to the sizes of struct wb_recording_stream); *id receives its
 * number (0, 1, ...). */
WB_MUST_CHECK enum wb_status wb_recording_add_stream(struct wb_recording *recording,
                                                     enum wb_role role, const char *address,
                                                     const char *protocol, const char *settings,
                                                     int *id);

/* One read or datagram, verbatim. Appends are grouped in a transaction until wb_recording_flush()
 * (the caller flushes every 100 ms). WB_ERR_IO when the disk is full: what was flushed before
 * stays readable. */
WB_MUST_CHECK enum wb_status wb_recording_append_chunk(struct wb_recording *recording, int stream,
                                                       int64_t seq, int64_t t_ns, const void *bytes,
                                                       size_t n);
WB_MUST_CHECK enum wb_status wb_recording_append_event(struct wb_recording *recording, int64_t t_ns,
                                                       const char *kind, const char *text);
WB_MUST_CHECK enum wb_status wb_recording_append_clock(struct wb_recording *recording, int stream,
                                                       int64_t t_host_ns, double t_device,
                                                       int64_t rtt_ns);
/* Once a write or a flush failed, all that was appended since the last good flush is gone: the
 * caller appends it again, or gives up. Appending goes on where the last good flush ended, so that
 * the disk may come back. Failures after the first give no message until something could be
 * flushed. A recording whose last flush failed is not closed properly. */
WB_MUST_CHECK enum wb_status wb_recording_flush(struct wb_recording *recording);

/* Flushes, checkpoints, leaves one plain file, and frees. Accepts NULL. For a recording opened for
 * reading it only frees. */
WB_MUST_CHECK enum wb_status wb_recording_close(struct wb_recording *recording);

/* --- reading --- */

/* Opens for reading; a `.zst` is decompressed into an unlinked temporary file. A file that is not
 * a recording, or of a newer schema, is refused with the reason. A truncated or damaged database
 * is opened as far as SQLite can read it. */
WB_MUST_CHECK enum wb_status wb_recording_open(struct wb_recording **out, const char *path);
/* The same without the warning that a file is cut short. `why` receives why opening fails and, as
 * long as the recording is open, why reading does: table after table that breaks off, "; " between
 * them. NULL: that is logged. */
WB_MUST_CHECK enum wb_status wb_recording_open_with_reason(struct wb_recording **out,
                                                           const char *path, struct wb_reason *why);
/* Logs that warning where it is due, and what is wrong with the log. */
void wb_recording_warn_cut_short(const struct wb_recording *recording);
/* True when the file is shorter than its own header says. This is logged once, on opening; tables
 * of such a file break off (WB_ERR_DATA) without further messages. For other files, each table that
 * breaks off is told once. */
bool wb_recording_is_cut_short(const struct wb_recording *recording);

/* What is wrong with the write-ahead log (`-wal`) of a recording that was not closed: it is not
 * there, or damaged, and what is in it is not read. False when nothing is. 240 bytes hold the text.
 */
bool wb_recording_log_problem(const struct wb_recording *recording, char *text, size_t size);

/* False when the recording was not closed properly (crash, full disk) or the file is cut short. */
bool wb_recording_is_complete(const struct wb_recording *recording);

/* Text of a meta key into an allocated string (caller frees); WB_ERR_NOT_FOUND without logging
 * when the key is not there. */
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
/* The settings text the stream was declared with; "" when none. */
const char *wb_recording_stream_settings(const struct wb_recording *recording, int index);

/* One read of a port, or one datagram. */
struct wb_chunk {
    int stream;
    int64_t seq, t_ns;
    const uint8_t *bytes; /* valid until the next call */
    size_t n;
    bool intact; /* as it was written; otherwise nothing of it can be relied on (of schema 1: its
                    bytes cannot) */
};

/* Something that happened, in words: a step of the test, a remark on an instrument, a mark. */
struct wb_event {
    int64_t t_ns;
    char kind[32];
    char text[1024];
};

/* One probe of a device's clock: what it read at the middle of the round trip. */
struct wb_clock_row {
    int stream;
    int64_t t_host_ns;
    double t_device;
    int64_t rtt_ns;
};

/* What wb_recording_check() finds. The places are lists in words, "row 12 (meta 'rig'), row 700
 * (stream 1, chunk 33), ...". */
struct wb_recording_check {
    bool is_protected;     /* everything is under a checksum (schema 2) */
    bool is_broken;        /* the database itself is damaged */
    bool is_closed;        /* the last row, the digest, is there */
    bool digest_fits;      /* and it is that of the rows */
    uint64_t rows;         /* that could be read */
    uint64_t damaged;      /* of them not as they were written */
    uint64_t lost;         /* rows that are not there, those at the end not counted */
    uint64_t displaced;    /* rows that do not follow the one before */
    uint64_t after_digest; /* rows behind the last one */
    char damaged_where[160], lost_where[160], displaced_where[160];
};

/* Reads every row and compares it with its checksum, its place, the chain and the digest. Of schema
 * 1 only the bytes of chunks can be compared. */
WB_MUST_CHECK enum wb_status wb_recording_check(struct wb_recording *recording,
                                                struct wb_recording_check *check);

/* Visits all chunks in order of arrival (t_ns, then stream, then seq; ties in the order of
 * writing); events and clock rows are visited in order of time as well. Damaged chunks are visited
 * with `intact` false; other rows that are damaged are passed over as if they could not be read. A
 * visitor returns a status: anything but WB_OK ends the walk and is returned. WB_ERR_DATA (told)
 * when the database breaks off or rows cannot be read; everything else has been visited. */
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

/* wb_recording_sha256() of a recording that is open for reading, without decompressing it again.
 * The reason for a failure goes where the recording was opened with. */
WB_MUST_CHECK enum wb_status wb_recording_hash(const struct wb_recording *recording, char hex[65]);

/* SHA-256 of the uncompressed database as lower-case hex, 64 characters and a NUL. Of a recording
 * that was not closed: of the file followed by its write-ahead log (`-wal`); of a compressed one
 * that is cut short: of what can be decompressed. `why` receives why it failed. NULL: that is
 * logged. */
WB_MUST_CHECK enum wb_status wb_recording_sha256(const char *path, char hex[65],
                                                 struct wb_reason *why);

#endif
