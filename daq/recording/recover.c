#include "daq/recording/recover.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/config.h"
#include "base/file.h"
#include "base/version.h"
#include "daq/recording/recording_salvage.h"

#define WB_LOG_DOMAIN "recover"

/* Rows per flush. */
#define BATCH 5000

/* A file mapped into memory. */
struct bytes {
    const uint8_t *at;
    size_t n;
};

static enum wb_status map(int descriptor, const char *path, struct bytes *bytes,
                          struct wb_reason *why)
{
    struct stat info;
    *bytes = (struct bytes){(const uint8_t *)"", 0};
    if (fstat(descriptor, &info) != 0)
        return wb_fail_to(why, WB_ERR_IO, "cannot read '%s': %s", path, strerror(errno));
    if (info.st_size == 0)
        return WB_OK;
    void *const at = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (at == MAP_FAILED)
        return wb_fail_to(why, WB_ERR_IO, "cannot read '%s': %s", path, strerror(errno));
    *bytes = (struct bytes){at, (size_t)info.st_size};
    return WB_OK;
}

static void unmap(struct bytes *bytes)
{
    if (bytes->n > 0)
        munmap((void *)(uintptr_t)bytes->at, bytes->n);
    bytes->n = 0;
}

/* Source and target of the rows. */
struct recovery {
    const char *from;
    struct bytes file, log;
    struct wb_recording *to;
    struct wb_recover *found;
    struct wb_reason *why;
    uint64_t unflushed;
    int64_t last; /* number of the previous row */
};

/* --- reading the source --- */

/* A truncated file is decompressed as far as possible. */
static enum wb_status map_decompressed(struct recovery *r, int from)
{
    char temporary[WB_PATH];
    int to;
    bool whole;
    unmap(&r->file);
    WB_TRY(wb_recording_temporary(temporary, sizeof temporary, &to, r->why));
    unlink(temporary);
    enum wb_status status = wb_recording_decompress(from, to, r->from, &whole, r->why);
    if (status == WB_OK)
        status = map(to, r->from, &r->file, r->why);
    close(to);
    return status;
}

static enum wb_status open_file(struct recovery *r)
{
    const int descriptor = open(r->from, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return wb_fail_to(r->why, errno == ENOENT ? WB_ERR_NOT_FOUND : WB_ERR_IO,
                          "cannot open '%s': %s", r->from, strerror(errno));
    enum wb_status status = map(descriptor, r->from, &r->file, r->why);
    if (status == WB_OK && wb_recording_is_zstd(r->file.at, r->file.n))
        status = map_decompressed(r, descriptor);
    close(descriptor);
    return status;
}

static enum wb_status open_log(struct recovery *r)
{
    char path[WB_PATH];
    const int n = snprintf(path, sizeof path, "%s-wal", r->from);
    const int descriptor = n > 0 && n < WB_PATH ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (descriptor < 0) {
        if (errno != ENOENT)
            return wb_fail_to(r->why, WB_ERR_IO, "cannot open '%s': %s", path, strerror(errno));
        r->found->is_log_missing = wb_recording_needs_log(r->file.at, r->file.n);
        return WB_OK;
    }
    const enum wb_status status = map(descriptor, path, &r->log, r->why);
    close(descriptor);
    return status;
}

/* --- rows --- */

static bool is_key(const struct wb_recording_row *row, const char *key)
{
    return row->kind == WB_RECORDING_META && row->values[0].n == strlen(key) &&
           memcmp(row->values[0].bytes, key, row->values[0].n) == 0;
}

static void note_missing(struct wb_recover *found, int64_t first, int64_t last)
{
    char place[64];
    snprintf(place, sizeof place, first == last ? "%" PRId64 : "%" PRId64 " to %" PRId64, first,
             last);
    found->missing += (uint64_t)(last - first) + 1;
    wb_recording_add_place(found->missing_where, sizeof found->missing_where, place);
}

static void note_chunk(struct wb_recover *found, const struct wb_recording_row *row)
{
    const int64_t stream = row->values[0].integer, seq = row->values[1].integer;
    const int64_t t_ns = row->values[2].integer;
    if (found->first_ns == 0)
        found->first_ns = t_ns;
    found->last_ns = t_ns;
    if (stream < 0 || stream >= WB_RECOVER_STREAMS)
        return;
    struct wb_recover_stream *const s = &found->streams[stream];
    s->chunks++;
    if (seq > s->next)
        s->missing += (uint64_t)(seq - s->next);
    if (seq >= s->next && seq < INT64_MAX)
        s->next = seq + 1;
}

static enum wb_status take_row(void *context, const struct wb_recording_row *row)
{
    struct recovery *const r = context;
    struct wb_recover *const found = r->found;
    if (!row->intact || row->is_nothing) {
        found->damaged++;
        return WB_OK;
    }
    if (found->is_protected && row->number > r->last + 1)
        note_missing(found, r->last + 1, row->number - 1);
    r->last = row->number;
    found->rows++;
    found->is_end_known = is_key(row, found->is_protected ? WB_RECORDING_DIGEST : "closed") ||
                          (!found->is_protected && found->is_end_known);
    if (row->kind == WB_RECORDING_CHUNK)
        note_chunk(found, row);
    /* Not copied: closing the new file writes these rows again. */
    if (is_key(row, WB_RECORDING_DIGEST) || is_key(row, "closed"))
        return WB_OK;
    WB_TRY(wb_recording_append_row(r->to, row->kind, row->values));
    if (++r->unflushed < BATCH)
        return WB_OK;
    r->unflushed = 0;
    return wb_recording_flush(r->to);
}

static enum wb_status take_salvage(struct recovery *r, struct wb_recording_salvage *salvage)
{
    const size_t n = wb_recording_salvage_count(salvage);
    r->found->is_protected = true;
    for (size_t i = 0; i < n; i++) {
        struct wb_recording_row row;
        wb_recording_salvage_row(salvage, i, &row);
        WB_TRY(take_row(r, &row));
    }
    return WB_OK;
}

/* Takes the rows of schema 1, which have no checksum that identifies them in a damaged file: SQLite
 * reads them from a copy. */
static enum wb_status take_old(struct recovery *r)
{
    char path[WB_PATH], log[WB_PATH + 8], index[WB_PATH + 8];
    struct wb_recording *old = NULL;
    struct wb_reason reason = {{0}};
    int descriptor;
    WB_TRY(wb_recording_temporary(path, sizeof path, &descriptor, r->why));
    close(descriptor);
    snprintf(log, sizeof log, "%s-wal", path);
    snprintf(index, sizeof index, "%s-shm", path);
    enum wb_status status = wb_file_write(path, r->file.at, r->file.n);
    if (status == WB_OK && r->log.n > 0)
        status = wb_file_write(log, r->log.at, r->log.n);
    if (status == WB_OK && wb_recording_open_with_reason(&old, path, &reason) != WB_OK)
        status = wb_fail_to(r->why, WB_ERR_FORMAT,
                            "'%s' contains no row of a recording: it is not a recording, or it is "
                            "completely destroyed",
                            r->from);
    if (status == WB_OK)
        status = wb_recording_scan(old, take_row, r, &r->found->is_broken);
    if (wb_recording_close(old) != WB_OK && status == WB_OK)
        status = WB_ERR_IO;
    unlink(path);
    unlink(log);
    unlink(index);
    return status;
}

static enum wb_status take_all(struct recovery *r)
{
    struct wb_recording_salvage *const salvage =
        wb_recording_salvage_find(r->file.at, r->file.n, r->log.at, r->log.n);
    const enum wb_status status =
        wb_recording_salvage_count(salvage) > 0 ? take_salvage(r, salvage) : take_old(r);
    wb_recording_salvage_destroy(salvage);
    WB_TRY(status);
    return r->found->rows > 0 ? WB_OK
                              : wb_fail_to(r->why, WB_ERR_FORMAT,
                                           "'%s' contains no intact row of a recording", r->from);
}

/* --- writing the target --- */

static enum wb_status put_meta(struct recovery *r)
{
    char tool[128], missing[600];
    snprintf(tool, sizeof tool, "wirebench %s (%s)", wb_version(), wb_version_revision());
    wb_recover_missing(r->found, missing, sizeof missing);
    WB_TRY(wb_recording_set_meta(r->to, WB_RECOVER_META_FROM, wb_file_name(r->from)));
    WB_TRY(wb_recording_set_meta(r->to, WB_RECOVER_META_SHA256, r->found->sha256));
    WB_TRY(wb_recording_set_meta(r->to, WB_RECOVER_META_TOOL, tool));
    return wb_recording_set_meta(r->to, WB_RECOVER_META_MISSING, missing);
}

static enum wb_status write_to(struct recovery *r, const char *path)
{
    WB_TRY(wb_recording_create(&r->to, path));
    enum wb_status status = take_all(r);
    if (status == WB_OK)
        status = put_meta(r);
    const enum wb_status closed = wb_recording_close(r->to);
    return status != WB_OK ? status : closed;
}

/* Writes the new file under a temporary name; it gets its final name when it is complete. */
static enum wb_status write_whole(struct recovery *r, const char *to)
{
    static const char *const endings[] = {"", "-wal", "-shm"};
    char path[WB_PATH];
    const int n = snprintf(path, sizeof path - 8, "%s.part", to);
    if (n < 0 || n >= WB_PATH - 8)
        return wb_fail_to(r->why, WB_ERR_ARGUMENT, "path '%.100s...' is too long", to);
    if (wb_file_exists(path))
        return wb_fail_to(r->why, WB_ERR_EXISTS,
                          "'%s' exists: another recovery is running or was interrupted; delete the "
                          "file if none is running",
                          path);
    enum wb_status status = write_to(r, path);
    /* link() fails if the name exists; rename() would overwrite the file. */
    if (status == WB_OK && link(path, to) != 0)
        status = wb_fail_to(r->why, errno == EEXIST ? WB_ERR_EXISTS : WB_ERR_IO,
                            "cannot create '%s': %s", to, strerror(errno));
    for (size_t i = 0; i < WB_COUNT(endings); i++) {
        char name[WB_PATH + 8];
        snprintf(name, sizeof name, "%s%s", path, endings[i]);
        unlink(name);
    }
    return status;
}

enum wb_status wb_recover_run(const char *from, const char *to, struct wb_recover *found,
                              struct wb_reason *why)
{
    struct recovery r = {.from = from, .found = found, .why = why};
    *found = (struct wb_recover){.rows = 0};
    if (wb_file_exists(to))
        return wb_fail_to(why, WB_ERR_EXISTS,
                          "'%s' exists: recordings are never overwritten; choose another name", to);
    enum wb_status status = open_file(&r);
    if (status == WB_OK)
        status = open_log(&r);
    if (status == WB_OK)
        status = wb_recording_sha256(from, found->sha256, why);
    if (status == WB_OK)
        status = write_whole(&r, to);
    unmap(&r.file);
    unmap(&r.log);
    return status;
}

/* --- missing rows --- */

static uint64_t missing_chunks(const struct wb_recover *found)
{
    uint64_t n = 0;
    for (int i = 0; i < WB_RECOVER_STREAMS; i++)
        n += found->streams[i].missing;
    return n;
}

bool wb_recover_is_whole(const struct wb_recover *found)
{
    return found->is_end_known && found->missing == 0 && found->damaged == 0 && !found->is_broken &&
           missing_chunks(found) == 0;
}

void wb_recover_missing(const struct wb_recover *found, char *text, size_t size)
{
    size_t n = 0;
    text[0] = '\0';
#define ADD_CLAUSE(...)                                                                            \
    do {                                                                                           \
        if (n < size)                                                                              \
            n += (size_t)snprintf(text + n, size - n, "%s", n ? "; " : "");                        \
        if (n < size)                                                                              \
            n += (size_t)snprintf(text + n, size - n, __VA_ARGS__);                                \
    } while (0)
    if (found->missing > 0)
        ADD_CLAUSE("%" PRIu64 " row%s (%s)", found->missing, found->missing == 1 ? "" : "s",
                   found->missing_where);
    if (found->damaged > 0)
        ADD_CLAUSE("%" PRIu64 " damaged row%s", found->damaged, found->damaged == 1 ? "" : "s");
    if (found->is_broken)
        ADD_CLAUSE("rows that could not be read");
    for (int i = 0; i < WB_RECOVER_STREAMS; i++) {
        const struct wb_recover_stream *const s = &found->streams[i];
        if (s->missing > 0)
            ADD_CLAUSE("stream %d: %" PRIu64 " of %" PRIu64 " chunks", i, s->missing,
                       s->missing + s->chunks);
    }
    if (!found->is_end_known)
        ADD_CLAUSE("possibly the end: the row that closing writes is missing");
    if (found->is_log_missing && !found->is_end_known)
        ADD_CLAUSE("the write-ahead log (-wal)");
#undef ADD_CLAUSE
}
