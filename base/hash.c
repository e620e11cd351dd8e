#include "base/hash.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <glib.h>

#define WB_LOG_DOMAIN "hash"

static void finish(GChecksum *checksum, char hex[WB_SHA256_TEXT])
{
    snprintf(hex, WB_SHA256_TEXT, "%s", g_checksum_get_string(checksum));
    g_checksum_free(checksum);
}

enum wb_status wb_hash_descriptor(int descriptor, const char *name, char hex[WB_SHA256_TEXT],
                                  struct wb_reason *why)
{
    GChecksum *checksum = g_checksum_new(G_CHECKSUM_SHA256);
    for (off_t at = 0;;) {
        unsigned char block[65536];
        const ssize_t n = pread(descriptor, block, sizeof block, at);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            g_checksum_free(checksum);
            return wb_fail_to(why, WB_ERR_IO, "cannot read '%s': %s", name, strerror(errno));
        }
        if (n == 0)
            break;
        g_checksum_update(checksum, block, (gssize)n);
        at += n;
    }
    finish(checksum, hex);
    return WB_OK;
}

enum wb_status wb_hash_file(const char *path, char hex[WB_SHA256_TEXT])
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return wb_fail(errno == ENOENT ? WB_ERR_NOT_FOUND : WB_ERR_IO, "cannot open '%s': %s", path,
                       strerror(errno));
    const enum wb_status status = wb_hash_descriptor(descriptor, path, hex, NULL);
    close(descriptor);
    return status;
}

void wb_hash_bytes(const void *bytes, size_t n, char hex[WB_SHA256_TEXT])
{
    GChecksum *checksum = g_checksum_new(G_CHECKSUM_SHA256);
    g_checksum_update(checksum, bytes, (gssize)n);
    finish(checksum, hex);
}

/* struct wb_hash is GLib's GChecksum under another name; it is never defined. */

struct wb_hash *wb_hash_create(void)
{
    return (struct wb_hash *)g_checksum_new(G_CHECKSUM_SHA256);
}

void wb_hash_add(struct wb_hash *hash, const void *bytes, size_t n)
{
    g_checksum_update((GChecksum *)hash, bytes, (gssize)n);
}

void wb_hash_so_far(const struct wb_hash *hash, char hex[WB_SHA256_TEXT])
{
    finish(g_checksum_copy((const GChecksum *)hash), hex);
}

void wb_hash_destroy(struct wb_hash *hash)
{
    if (hash)
        g_checksum_free((GChecksum *)hash);
}
