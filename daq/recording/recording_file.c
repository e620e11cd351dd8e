/* Files of recordings: compression, temporary files, checksums. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

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
        const ssize_t n = TEMP_FAILURE_RETRY(read(from, d->in, d->in_size));
        if (n < 0)
            return wb_fail_to(why, WB_ERR_IO, "cannot read '%s': %s", path, strerror(errno));
        ZSTD_inBuffer in = {.src = d->in, .size = (size_t)n};
        if (n == 0) {
            *whole = left == 0;
            return WB_OK;
        }
        while (in.pos < in.size) {
            ZSTD_outBuffer out = {.dst = d->out, .size = d->out_size};
            left = ZSTD_decompressStream(d->stream, &out, &in);
            WB_TRY(write_all(to, d->out, out.pos,
                             "a decompressed recording to the temporary folder ($TMPDIR)", why));
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
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return wb_fail_to(why, errno == ENOENT ? WB_ERR_NOT_FOUND : WB_ERR_IO,
                          "cannot read '%s': %s", path, strerror(errno));
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
