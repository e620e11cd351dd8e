/* Between the parts of the recording: recording_write.c, recording_read.c, recording_file.c. Only
 * these include sqlite3.h, zlib.h and zstd.h. */
#ifndef WB_DAQ_RECORDING_PRIVATE_H
#define WB_DAQ_RECORDING_PRIVATE_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/recording.h"

/* "WBR1" */
#define WB_RECORDING_APPLICATION_ID 0x57425231

/* A read or datagram has at most 64 KiB; longer blobs are damage. */
#define WB_RECORDING_LONGEST_VALUE (16 << 20)

struct wb_recording {
    sqlite3 *db;
    char *path;
    struct wb_reason *why; /* of reading; NULL: it is logged */
    bool writing;
    /* Writing. */
    sqlite3_stmt *insert_chunk, *insert_event, *insert_clock, *insert_meta, *insert_stream;
    bool in_transaction;
    enum wb_status failed; /* latched: the first error of a write */
    /* Reading. */
    bool compressed; /* .zst */
    bool complete;   /* closed properly */
    bool shortened;  /* the file is shorter than its own header says, or not all decompressed */
    int64_t bytes_there, bytes_expected; /* decompressed; as the file's own header counts them */
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

/* zlib's CRC-32, that of `crc32` and gzip. */
uint32_t wb_recording_crc32(const void *bytes, size_t n);

/* A new file in the temporary folder ($TMPDIR, else /tmp), open for reading and writing; `path`
 * receives its name, and the caller unlinks it. */
WB_MUST_CHECK enum wb_status wb_recording_temporary(char *path, size_t size, int *descriptor,
                                                    struct wb_reason *why);

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
