/* Files of recordings: compression, temporary files, checksums. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include "base/compress.h"
#include "base/file.h"
#include "base/hash.h"
#include "daq/recording/recording_private.h"

#define WB_LOG_DOMAIN "recording"

bool wb_recording_is_zstd(const uint8_t *bytes, size_t n)
{
    static const uint8_t magic[] = {0x28, 0xb5, 0x2f, 0xfd};
    return n >= sizeof magic && memcmp(bytes, magic, sizeof magic) == 0;
}

enum wb_status wb_recording_temporary(char *path, size_t size, int *descriptor,
                                      struct wb_reason *why)
{
    const char *folder = getenv("TMPDIR");
    if (!folder || !folder[0])
        folder = "/tmp";
    int n = snprintf(path, size, "%s/wirebench-XXXXXX", folder);
    if (n < 0 || (size_t)n >= size)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "the path of the temporary folder is too long");
    *descriptor = mkostemp(path, O_CLOEXEC);
    if (*descriptor < 0)
        return wb_fail_to(why, WB_ERR_IO, "cannot create a temporary file in '%s': %s", folder,
                          strerror(errno));
    return WB_OK;
}

static enum wb_status write_all(int to, const void *bytes, size_t n, const char *what,
                                struct wb_reason *why)
{
    size_t done = 0;
    while (done < n) {
        ssize_t put = write(to, (const char *)bytes + done, n - done);
        if (put > 0)
            done += (size_t)put;
        else if (put == 0 || errno != EINTR)
            return wb_fail_to(why, WB_ERR_IO, "cannot write %s: %s", what,
                              strerror(put ? errno : ENOSPC));
    }
    return WB_OK;
}

/* Reads a block of the compressed file; *n is 0 at its end. */
static enum wb_status read_block(int from, void *block, size_t size, const char *path, size_t *n,
                                 struct wb_reason *why)
{
    for (;;) {
        ssize_t got = read(from, block, size);
        if (got >= 0) {
            *n = (size_t)got;
            return WB_OK;
        }
        if (errno != EINTR)
            return wb_fail_to(why, WB_ERR_IO, "cannot read '%s': %s", path, strerror(errno));
    }
}

struct decompression {
    ZSTD_DStream *stream;
    void *in, *out;
    size_t in_size, out_size;
};

static enum wb_status decompress_all(struct decompression *d, int from, int to, const char *path,
                                     bool *whole, struct wb_reason *why)
{
    size_t left = 1; /* result of ZSTD_decompressStream(): 0 at the end of a frame */
    for (;;) {
        ZSTD_inBuffer in = {.src = d->in};
        WB_TRY(read_block(from, d->in, d->in_size, path, &in.size, why));
        if (in.size == 0) {
            *whole = left == 0;
            return WB_OK;
        }
        while (in.pos < in.size) {
            ZSTD_outBuffer out = {.dst = d->out, .size = d->out_size};
            left = ZSTD_decompressStream(d->stream, &out, &in);
            WB_TRY(write_all(to, d->out, out.pos,
                             "a decompressed recording to the temporary "
                             "folder ($TMPDIR)",
                             why));
            if (ZSTD_isError(left)) {
                *whole = false;
                return WB_OK;
            }
        }
    }
}

enum wb_status wb_recording_decompress(int from, int to, const char *path, bool *whole,
                                       struct wb_reason *why)
{
    struct decompression d = {.in_size = ZSTD_DStreamInSize(), .out_size = ZSTD_DStreamOutSize()};
    d.stream = ZSTD_createDStream();
    d.in = malloc(d.in_size);
    d.out = malloc(d.out_size);
    enum wb_status status = WB_OK;
    if (!d.stream || !d.in || !d.out)
        status = wb_fail_to(why, WB_ERR_MEMORY, "out of memory decompressing '%s'", path);
    else
        status = decompress_all(&d, from, to, path, whole, why);
    ZSTD_freeDStream(d.stream);
    free(d.in);
    free(d.out);
    return status;
}

static enum wb_status open_file(const char *path, int *descriptor, struct wb_reason *why)
{
    *descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (*descriptor >= 0)
        return WB_OK;
    return wb_fail_to(why, errno == ENOENT ? WB_ERR_NOT_FOUND : WB_ERR_IO, "cannot read '%s': %s",
                      path, strerror(errno));
}

/* Finds the write-ahead log, which holds a part of a recording that was not closed. */
static bool find_wal(const char *path, char wal[WB_PATH])
{
    struct stat there;
    int n = snprintf(wal, WB_PATH, "%s-wal", path);
    return n > 0 && n < WB_PATH && stat(wal, &there) == 0 && there.st_size > 0;
}

static enum wb_status append_file(int to, const char *path, struct wb_reason *why)
{
    char *bytes = NULL;
    size_t size = 0;
    WB_TRY(wb_file_read_with_reason(path, &bytes, &size, why));
    enum wb_status status =
        write_all(to, bytes, size, "a recording to the temporary folder ($TMPDIR)", why);
    free(bytes);
    return status;
}

/* Hashes the decompressed contents of `from` or, if it is not compressed, the file followed by its
 * log. */
static enum wb_status hash_whole(const char *path, int from, const char *wal, char hex[65],
                                 struct wb_reason *why)
{
    char temporary[WB_PATH];
    int to = -1;
    bool whole = true;
    WB_TRY(wb_recording_temporary(temporary, sizeof temporary, &to, why));
    unlink(temporary);
    enum wb_status status = from >= 0 ? wb_recording_decompress(from, to, path, &whole, why)
                                      : append_file(to, path, why);
    if (status == WB_OK && from < 0)
        status = append_file(to, wal, why);
    /* A truncated file is hashed as far as it goes, as without compression; opening reports it. */
    if (status == WB_OK)
        status = wb_hash_descriptor(to, path, hex, why);
    close(to);
    return status;
}

enum wb_status wb_recording_sha256(const char *path, char hex[65], struct wb_reason *why)
{
    char wal[WB_PATH];
    if (find_wal(path, wal))
        return hash_whole(path, -1, wal, hex, why);
    int descriptor;
    WB_TRY(open_file(path, &descriptor, why));
    uint8_t magic[4];
    ssize_t n = pread(descriptor, magic, sizeof magic, 0);
    enum wb_status status;
    if (n > 0 && wb_recording_is_zstd(magic, (size_t)n))
        status = hash_whole(path, descriptor, NULL, hex, why);
    else
        status = wb_hash_descriptor(descriptor, path, hex, why);
    close(descriptor);
    return status;
}

static enum wb_status write_compressed(const char *target, const void *bytes, size_t size)
{
    char temporary[WB_PATH];
    int n = snprintf(temporary, sizeof temporary, "%s.XXXXXX", target);
    if (n < 0 || (size_t)n >= sizeof temporary)
        return wb_fail(WB_ERR_ARGUMENT, "path '%.100s...' is too long", target);
    int to = mkostemp(temporary, O_CLOEXEC);
    if (to < 0)
        return wb_fail(WB_ERR_IO, "cannot create a temporary file beside '%s': %s", target,
                       strerror(errno));
    enum wb_status status = write_all(to, bytes, size, target, NULL);
    if (status == WB_OK && (fchmod(to, 0644) != 0 || fsync(to) != 0))
        status = wb_fail(WB_ERR_IO, "cannot write '%s': %s", target, strerror(errno));
    close(to);
    /* link() fails if the name exists; rename() would overwrite the file. */
    if (status == WB_OK && link(temporary, target) != 0)
        status = wb_fail(errno == EEXIST ? WB_ERR_EXISTS : WB_ERR_IO, "cannot create '%s': %s",
                         target, strerror(errno));
    unlink(temporary);
    return status;
}

enum wb_status wb_recording_compress(const char *path, const char *target)
{
    char wal[WB_PATH];
    if (find_wal(path, wal))
        return wb_fail(WB_ERR_BUSY, "'%s' is being recorded or was not closed", path);
    if (wb_file_exists(target))
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' exists: recordings are never overwritten; choose another name",
                       target);
    char *bytes = NULL;
    size_t size = 0;
    WB_TRY(wb_file_read(path, &bytes, &size));
    if (size < 16 || memcmp(bytes, "SQLite format 3", 16) != 0) {
        free(bytes);
        return wb_fail(WB_ERR_FORMAT, "'%s' is not a recording", path);
    }
    void *packed;
    size_t packed_size;
    enum wb_status status =
        wb_compress(bytes, size, WB_COMPRESS_STORED, path, &packed, &packed_size, NULL);
    if (status == WB_OK) {
        status = write_compressed(target, packed, packed_size);
        free(packed);
    }
    free(bytes);
    return status;
}
