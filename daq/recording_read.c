/* Recordings being read: opening what can be opened, and walking the tables. */
#include "daq/recording.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "daq/recording_private.h"

#define WB_LOG_DOMAIN "recording"

/* --- what the file is --- */

#define HEADER_BYTES 100

static uint32_t big_endian(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* Reads SQLite's file header (https://www.sqlite.org/fileformat.html, 1.3). */
static enum wb_status check_header(struct wb_recording *recording, int descriptor)
{
    uint8_t header[HEADER_BYTES];
    ssize_t n = pread(descriptor, header, sizeof header, 0);
    struct stat there;
    if (n < 0 || fstat(descriptor, &there) != 0)
        return wb_fail_also(recording->why, WB_ERR_IO, "cannot read '%s': %s", recording->path,
                            strerror(errno));
    if (n < HEADER_BYTES || memcmp(header, "SQLite format 3", 16) != 0)
        return wb_fail_also(recording->why, WB_ERR_FORMAT, "'%s' is not a recording%s",
                            recording->path, n == 0 ? ": the file is empty" : "");
    if (big_endian(header + 68) != WB_RECORDING_APPLICATION_ID)
        return wb_fail_also(recording->why, WB_ERR_FORMAT,
                            "'%s' is not a recording: it is an SQLite database of another program",
                            recording->path);
    uint32_t version = big_endian(header + 60);
    if (version > WB_RECORDING_SCHEMA)
        return wb_fail_also(
            recording->why, WB_ERR_UNSUPPORTED,
            "'%s' is of schema %u, and this program knows schemas up to %d only: use a newer "
            "wirebench",
            recording->path, version, WB_RECORDING_SCHEMA);
    int64_t page = (int64_t)header[16] << 8 | header[17];
    if (page == 1)
        page = 65536;
    recording->bytes_there = there.st_size;
    recording->bytes_expected = page * (int64_t)big_endian(header + 28);
    if (there.st_size < recording->bytes_expected)
        recording->shortened = true;
    /* The smallest row takes more than four bytes. */
    recording->n_rows_max = there.st_size / 4 + 64;
    return WB_OK;
}

/* --- opening --- */

static char *make_uri(const char *path, const char *options)
{
    /* Only these three mean something in the path of a URI. */
    char *uri = malloc(3 * strlen(path) + strlen(options) + 16);
    if (!uri)
        return NULL;
    char *to = uri + sprintf(uri, "file:");
    /* A path that starts with two slashes would read as a host. */
    while (path[0] == '/' && path[1] == '/')
        path++;
    for (; *path; path++) {
        if (strchr("?#%", *path))
            to += sprintf(to, "%%%02X", (unsigned)(unsigned char)*path);
        else
            *to++ = *path;
    }
    sprintf(to, "?%s", options);
    return uri;
}

/* Opens the database and touches it; SQLite reads nothing before. */
static int open_database(struct wb_recording *recording, const char *path, const char *options)
{
    char *uri = make_uri(path, options);
    if (!uri)
        return SQLITE_NOMEM;
    int code = sqlite3_open_v2(uri, &recording->db,
                               SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, NULL);
    free(uri);
    if (code == SQLITE_OK) {
        sqlite3 *db = recording->db;
        sqlite3_extended_result_codes(db, 1);
        sqlite3_busy_timeout(db, 2000);
        /* A file cut short is refused as a whole unless the schema may be repaired. The schema of
         * a stranger's file runs nothing here. */
        sqlite3_db_config(db, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, NULL);
        sqlite3_db_config(db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
        sqlite3_db_config(db, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, NULL);
        sqlite3_db_config(db, SQLITE_DBCONFIG_ENABLE_VIEW, 0, NULL);
        sqlite3_limit(db, SQLITE_LIMIT_LENGTH, WB_RECORDING_LONGEST_VALUE);
        code = sqlite3_exec(db, "PRAGMA cell_size_check=ON; SELECT count(*) FROM sqlite_schema;",
                            NULL, NULL, NULL);
    }
    if (code != SQLITE_OK) {
        sqlite3_close(recording->db);
        recording->db = NULL;
    }
    return code;
}

static enum wb_status copy_file(const char *from, const char *to, struct wb_reason *why)
{
    char *bytes = NULL;
    size_t size = 0;
    WB_TRY(wb_file_read_with_reason(from, &bytes, &size, why));
    enum wb_status status = wb_file_write(to, bytes, size);
    free(bytes);
    return status;
}

/* A recording that was not closed, in a folder (or on a disk) where SQLite cannot put its index of
 * the write-ahead log: opened as a copy of both files. */
static enum wb_status open_copy(struct wb_recording *recording)
{
    char wal[WB_PATH], copy[WB_PATH], copy_of_wal[WB_PATH + 8], copy_of_shm[WB_PATH + 8];
    int descriptor = -1;
    snprintf(wal, sizeof wal, "%s-wal", recording->path);
    WB_TRY(wb_recording_temporary(copy, sizeof copy, &descriptor, recording->why));
    close(descriptor);
    snprintf(copy_of_wal, sizeof copy_of_wal, "%s-wal", copy);
    snprintf(copy_of_shm, sizeof copy_of_shm, "%s-shm", copy);
    enum wb_status status = copy_file(recording->path, copy, recording->why);
    if (status == WB_OK)
        status = copy_file(wal, copy_of_wal, recording->why);
    if (status == WB_OK) {
        int code = open_database(recording, copy, "mode=ro");
        if (code != SQLITE_OK)
            status = wb_recording_fail(recording, code, "open the recording");
    }
    unlink(copy);
    unlink(copy_of_wal);
    unlink(copy_of_shm);
    return status;
}

static enum wb_status open_plain(struct wb_recording *recording)
{
    char wal[WB_PATH];
    int n = snprintf(wal, sizeof wal, "%s-wal", recording->path);
    struct stat there;
    if (n < 0 || (size_t)n >= sizeof wal || stat(wal, &there) != 0) {
        /* Closed: nobody writes to it any more, so it needs neither locks nor other files. */
        int code = open_database(recording, recording->path, "immutable=1");
        return code == SQLITE_OK ? WB_OK : wb_recording_fail(recording, code, "open the recording");
    }
    recording->n_rows_max += there.st_size / 4;
    recording->shortened = false; /* the log may hold what the header counts */
    if (open_database(recording, recording->path, "mode=ro") == SQLITE_OK)
        return WB_OK;
    return open_copy(recording);
}

static enum wb_status open_compressed(struct wb_recording *recording, int descriptor)
{
    char temporary[WB_PATH];
    int to = -1;
    bool whole = true;
    WB_TRY(wb_recording_temporary(temporary, sizeof temporary, &to, recording->why));
    recording->compressed = true;
    enum wb_status status =
        wb_recording_decompress(descriptor, to, recording->path, &whole, recording->why);
    if (status == WB_OK)
        status = check_header(recording, to);
    if (!whole)
        recording->shortened = true;
    if (status == WB_OK) {
        int code = open_database(recording, temporary, "immutable=1");
        if (code != SQLITE_OK)
            status = wb_recording_fail(recording, code, "open the recording");
    }
    unlink(temporary);
    close(to);
    return status;
}

static enum wb_status open_any(struct wb_recording *recording, int descriptor)
{
    uint8_t magic[4];
    ssize_t n = pread(descriptor, magic, sizeof magic, 0);
    if (n > 0 && wb_recording_is_zstd(magic, (size_t)n))
        return open_compressed(recording, descriptor);
    WB_TRY(check_header(recording, descriptor));
    return open_plain(recording);
}

/* --- reading rows --- */

static enum wb_status prepare(struct wb_recording *recording, const char *sql,
                              sqlite3_stmt **statement)
{
    int code = sqlite3_prepare_v2(recording->db, sql, -1, statement, NULL);
    if (code == SQLITE_OK)
        return WB_OK;
    if (code == SQLITE_ERROR)
        return wb_fail_also(recording->why, WB_ERR_DATA, "'%s' is damaged: %s", recording->path,
                            sqlite3_errmsg(recording->db));
    return wb_recording_fail(recording, code, "read");
}

static bool is_news(struct wb_recording *recording, const char *table)
{
    for (size_t i = 0; i < recording->n_told; i++) {
        if (strcmp(recording->told[i], table) == 0)
            return false;
    }
    if (recording->n_told < sizeof recording->told / sizeof recording->told[0])
        recording->told[recording->n_told++] = table;
    return true;
}

/* The end of a walk: SQLite's last code, or a cycle in a damaged tree that would never end. */
static enum wb_status end_walk(struct wb_recording *recording, int code, int64_t rows,
                               const char *table)
{
    if (code == SQLITE_DONE)
        return WB_OK;
    const char *why =
        code == SQLITE_ROW ? "more rows than the file can hold" : sqlite3_errstr(code);
    if ((code & 0xff) == SQLITE_NOMEM)
        return wb_recording_fail(recording, code, "read");
    /* That a file is cut short was said when it was opened, and every table is walked twice. */
    if (recording->shortened || !is_news(recording, table))
        return WB_ERR_DATA;
    return wb_fail_also(recording->why, WB_ERR_DATA,
                        "'%s': table %s breaks off after %lld row%s: %s", recording->path, table,
                        (long long)rows, rows == 1 ? "" : "s", why);
}

static const char *text_of(sqlite3_stmt *statement, int column)
{
    const char *text = (const char *)sqlite3_column_text(statement, column);
    return text ? text : "";
}

static bool role_of(const char *name, enum wb_role *role)
{
    static const enum wb_role roles[] = {WB_ROLE_LOAD, WB_ROLE_MOCAP, WB_ROLE_STAGE};
    for (size_t i = 0; i < sizeof roles / sizeof roles[0]; i++) {
        if (strcmp(name, wb_role_name(roles[i])) == 0) {
            *role = roles[i];
            return true;
        }
    }
    return false;
}

static enum wb_status read_stream_row(struct wb_recording *recording, sqlite3_stmt *statement)
{
    struct wb_recording_stream stream = {.id = sqlite3_column_int(statement, 0)};
    if (!role_of(text_of(statement, 1), &stream.role)) {
        wb_warn("'%s': stream %d has the unknown role '%.40s' and is left out", recording->path,
                stream.id, text_of(statement, 1));
        return WB_OK;
    }
    snprintf(stream.address, sizeof stream.address, "%s", text_of(statement, 2));
    snprintf(stream.protocol, sizeof stream.protocol, "%s", text_of(statement, 3));
    return wb_recording_remember_stream(recording, &stream, text_of(statement, 4));
}

static enum wb_status read_streams(struct wb_recording *recording)
{
    sqlite3_stmt *statement = NULL;
    WB_TRY(prepare(recording,
                   "SELECT id, role, address, protocol, settings FROM stream ORDER BY id",
                   &statement));
    enum wb_status status = WB_OK;
    int code = SQLITE_DONE;
    int64_t rows = 0;
    while (status == WB_OK && (code = sqlite3_step(statement)) == SQLITE_ROW && rows++ < 1000)
        status = read_stream_row(recording, statement);
    if (status == WB_OK && end_walk(recording, code, rows, "stream") == WB_ERR_MEMORY)
        status = WB_ERR_MEMORY; /* otherwise said, and the rest may serve */
    sqlite3_finalize(statement);
    return status;
}

enum wb_status wb_recording_open_with_reason(struct wb_recording **out, const char *path,
                                             struct wb_reason *why)
{
    *out = NULL;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return wb_fail_also(why,
                            errno == ENOENT   ? WB_ERR_NOT_FOUND
                            : errno == EACCES ? WB_ERR_PERMISSION
                                              : WB_ERR_IO,
                            "cannot open '%s': %s", path, strerror(errno));
    struct wb_recording *recording = calloc(1, sizeof *recording);
    if (recording) {
        recording->why = why;
        recording->path = strdup(path);
    }
    enum wb_status status = WB_OK;
    if (!recording || !recording->path)
        status = wb_fail_also(why, WB_ERR_MEMORY, "out of memory for '%s'", path);
    if (status == WB_OK)
        status = open_any(recording, descriptor);
    close(descriptor);
    if (status == WB_OK)
        status = read_streams(recording);
    if (status != WB_OK) {
        if (recording)
            wb_recording_release(recording);
        return status;
    }
    char *closed = NULL;
    recording->complete =
        wb_recording_meta(recording, "closed", &closed) == WB_OK && !recording->shortened;
    free(closed);
    *out = recording;
    return WB_OK;
}

void wb_recording_warn_cut_short(const struct wb_recording *recording)
{
    if (recording->shortened)
        wb_warn("'%s' is cut short: %.1f of %.1f MB could be read; look for the original%s",
                recording->path, (double)recording->bytes_there * 1e-6,
                (double)recording->bytes_expected * 1e-6,
                recording->compressed ? "" : " or its -wal");
}

enum wb_status wb_recording_open(struct wb_recording **out, const char *path)
{
    WB_TRY(wb_recording_open_with_reason(out, path, NULL));
    wb_recording_warn_cut_short(*out);
    return WB_OK;
}

bool wb_recording_is_cut_short(const struct wb_recording *recording)
{
    return recording->shortened;
}

bool wb_recording_is_complete(const struct wb_recording *recording)
{
    return recording->complete;
}

int wb_recording_n_streams(const struct wb_recording *recording)
{
    return recording->n_streams;
}

const struct wb_recording_stream *wb_recording_stream_at(const struct wb_recording *recording,
                                                         int index)
{
    return index >= 0 && index < recording->n_streams ? &recording->streams[index] : NULL;
}

const char *wb_recording_stream_settings(const struct wb_recording *recording, int index)
{
    return index >= 0 && index < recording->n_streams ? recording->settings[index] : "";
}

/* --- meta --- */

struct meta_search {
    const char *key;
    char *value;
    struct wb_reason *why;
};

static enum wb_status match_meta(void *context, const char *key, const char *value)
{
    struct meta_search *search = context;
    if (strcmp(key, search->key) != 0)
        return WB_OK;
    free(search->value);
    search->value = strdup(value);
    return search->value
               ? WB_OK
               : wb_fail_also(search->why, WB_ERR_MEMORY, "out of memory for meta '%s'", key);
}

/* Walks without the key's index: a damaged file has one table less to trust. */
static enum wb_status walk_meta(struct wb_recording *recording, const char *sql,
                                enum wb_status (*visit)(void *, const char *, const char *),
                                void *context)
{
    sqlite3_stmt *statement = NULL;
    WB_TRY(prepare(recording, sql, &statement));
    enum wb_status status = WB_OK;
    int code = SQLITE_DONE;
    int64_t rows = 0;
    while (status == WB_OK && (code = sqlite3_step(statement)) == SQLITE_ROW) {
        if (recording->n_rows_max && rows++ >= recording->n_rows_max)
            break;
        status = visit(context, text_of(statement, 0), text_of(statement, 1));
    }
    if (status == WB_OK)
        status = end_walk(recording, code, rows, "meta");
    sqlite3_finalize(statement);
    return status;
}

enum wb_status wb_recording_meta(struct wb_recording *recording, const char *key, char **value)
{
    struct meta_search search = {.key = key, .why = recording->why};
    enum wb_status status =
        walk_meta(recording, "SELECT key, value FROM meta NOT INDEXED", match_meta, &search);
    if (search.value && status != WB_ERR_MEMORY) {
        *value = search.value;
        return WB_OK;
    }
    free(search.value);
    return status == WB_OK ? WB_ERR_NOT_FOUND : status;
}

enum wb_status wb_recording_each_meta(struct wb_recording *recording,
                                      enum wb_status (*visit)(void *context, const char *key,
                                                              const char *value),
                                      void *context)
{
    return walk_meta(recording, "SELECT key, value FROM meta NOT INDEXED ORDER BY key", visit,
                     context);
}

/* --- rows in order of time --- */

/* Where a row is and what it is sorted by. Sorting keys here instead of rows in SQLite lets a
 * damaged file give what comes before the damage, and keeps memory small. */
struct key {
    int64_t t_ns, seq, rowid;
    int stream;
};

struct keys {
    struct key *items;
    size_t n, capacity;
};

static int compare_keys(const void *a, const void *b)
{
    const struct key *x = a, *y = b;
    if (x->t_ns != y->t_ns)
        return x->t_ns < y->t_ns ? -1 : 1;
    if (x->stream != y->stream)
        return x->stream < y->stream ? -1 : 1;
    if (x->seq != y->seq)
        return x->seq < y->seq ? -1 : 1;
    return x->rowid < y->rowid ? -1 : x->rowid > y->rowid;
}

static enum wb_status append_key(struct keys *keys, const struct key *key, struct wb_reason *why)
{
    if (keys->n == keys->capacity) {
        size_t capacity = keys->capacity ? 2 * keys->capacity : 1024;
        struct key *larger = realloc(keys->items, capacity * sizeof *larger);
        if (!larger)
            return wb_fail_also(why, WB_ERR_MEMORY, "out of memory for %zu rows", capacity);
        keys->items = larger;
        keys->capacity = capacity;
    }
    keys->items[keys->n++] = *key;
    return WB_OK;
}

/* Reads rowid, time, stream and seq of all rows as far as they go. *end is WB_OK or why the table
 * broke off. A page that is only partly there reads as rows of nothing: rows without a time, or
 * out of the order that SQLite keeps, are the end. */
static enum wb_status read_keys(struct wb_recording *recording, const char *table, const char *sql,
                                struct keys *keys, enum wb_status *end)
{
    sqlite3_stmt *statement = NULL;
    WB_TRY(prepare(recording, sql, &statement));
    enum wb_status status = WB_OK;
    int code = SQLITE_DONE;
    while (status == WB_OK && (code = sqlite3_step(statement)) == SQLITE_ROW) {
        if (recording->n_rows_max && (int64_t)keys->n >= recording->n_rows_max)
            break;
        struct key key = {.rowid = sqlite3_column_int64(statement, 0),
                          .t_ns = sqlite3_column_int64(statement, 1),
                          .stream = sqlite3_column_int(statement, 2),
                          .seq = sqlite3_column_int64(statement, 3)};
        if (sqlite3_column_type(statement, 1) != SQLITE_INTEGER ||
            (keys->n > 0 && key.rowid <= keys->items[keys->n - 1].rowid)) {
            code = SQLITE_CORRUPT;
            break;
        }
        status = append_key(keys, &key, recording->why);
    }
    if (status == WB_OK)
        *end = end_walk(recording, code, (int64_t)keys->n, table);
    sqlite3_finalize(statement);
    return status;
}

/* One table to be walked: how to read its keys and one row, and what to do with the row. */
struct walk {
    const char *table, *keys_sql, *row_sql;
    enum wb_status (*row)(struct walk *walk, const struct key *key, sqlite3_stmt *statement);
    enum wb_status (*visit_chunk)(void *, const struct wb_chunk *);
    enum wb_status (*visit_event)(void *, const struct wb_event *);
    enum wb_status (*visit_clock)(void *, const struct wb_clock_row *);
    void *context;
};

/* Visits the rows. Those that cannot be read are counted in *n_lost and passed over. */
static enum wb_status visit_rows(struct wb_recording *recording, struct walk *walk,
                                 const struct keys *keys, size_t *n_lost)
{
    sqlite3_stmt *statement = NULL;
    WB_TRY(prepare(recording, walk->row_sql, &statement));
    enum wb_status status = WB_OK;
    for (size_t i = 0; i < keys->n && status == WB_OK; i++) {
        sqlite3_bind_int64(statement, 1, keys->items[i].rowid);
        int code = sqlite3_step(statement);
        if (code == SQLITE_ROW)
            status = walk->row(walk, &keys->items[i], statement);
        else if ((code & 0xff) == SQLITE_NOMEM)
            status = wb_recording_fail(recording, code, "read");
        else
            ++*n_lost;
        sqlite3_reset(statement);
    }
    sqlite3_finalize(statement);
    return status;
}

static enum wb_status walk_table(struct wb_recording *recording, struct walk *walk)
{
    struct keys keys = {0};
    enum wb_status end = WB_OK;
    enum wb_status status = read_keys(recording, walk->table, walk->keys_sql, &keys, &end);
    if (status == WB_OK) {
        bool sorted = true;
        for (size_t i = 1; i < keys.n && sorted; i++)
            sorted = compare_keys(&keys.items[i - 1], &keys.items[i]) <= 0;
        if (!sorted)
            qsort(keys.items, keys.n, sizeof keys.items[0], compare_keys);
        size_t n_lost = 0;
        status = visit_rows(recording, walk, &keys, &n_lost);
        if (status == WB_OK && end == WB_OK && n_lost > 0) {
            end = WB_ERR_DATA;
            if (!recording->shortened && is_news(recording, walk->table))
                end = wb_fail_also(recording->why, WB_ERR_DATA,
                                   "'%s': %zu row%s of table %s cannot be read", recording->path,
                                   n_lost, n_lost == 1 ? "" : "s", walk->table);
        }
    }
    free(keys.items);
    return status != WB_OK ? status : end;
}

static enum wb_status chunk_row(struct walk *walk, const struct key *key, sqlite3_stmt *statement)
{
    int64_t stored = sqlite3_column_int64(statement, 1);
    struct wb_chunk chunk = {.stream = key->stream,
                             .seq = key->seq,
                             .t_ns = key->t_ns,
                             .bytes = sqlite3_column_blob(statement, 0),
                             .n = (size_t)sqlite3_column_bytes(statement, 0),
                             .crc32 = (uint32_t)stored};
    if (!chunk.bytes) {
        chunk.bytes = (const uint8_t *)"";
        chunk.n = 0;
    }
    chunk.intact = sqlite3_column_type(statement, 0) == SQLITE_BLOB && stored >= 0 &&
                   stored == (int64_t)wb_recording_crc32(chunk.bytes, chunk.n);
    return walk->visit_chunk(walk->context, &chunk);
}

static enum wb_status event_row(struct walk *walk, const struct key *key, sqlite3_stmt *statement)
{
    struct wb_event event = {.t_ns = key->t_ns};
    snprintf(event.kind, sizeof event.kind, "%s", text_of(statement, 0));
    snprintf(event.text, sizeof event.text, "%s", text_of(statement, 1));
    return walk->visit_event(walk->context, &event);
}

static enum wb_status clock_row(struct walk *walk, const struct key *key, sqlite3_stmt *statement)
{
    struct wb_clock_row row = {.stream = key->stream,
                               .t_host_ns = key->t_ns,
                               .rtt_ns = sqlite3_column_int64(statement, 1)};
    row.t_device = sqlite3_column_type(statement, 0) == SQLITE_NULL
                       ? (double)NAN
                       : sqlite3_column_double(statement, 0);
    return walk->visit_clock(walk->context, &row);
}

enum wb_status wb_recording_each_chunk(struct wb_recording *recording,
                                       enum wb_status (*visit)(void *context,
                                                               const struct wb_chunk *chunk),
                                       void *context)
{
    struct walk walk = {.table = "chunk",
                        .keys_sql = "SELECT rowid, t_ns, stream, seq FROM chunk",
                        .row_sql = "SELECT bytes, crc32 FROM chunk WHERE rowid = ?",
                        .row = chunk_row,
                        .visit_chunk = visit,
                        .context = context};
    return walk_table(recording, &walk);
}

enum wb_status wb_recording_each_event(struct wb_recording *recording,
                                       enum wb_status (*visit)(void *context,
                                                               const struct wb_event *event),
                                       void *context)
{
    struct walk walk = {.table = "event",
                        .keys_sql = "SELECT rowid, t_ns, 0, 0 FROM event",
                        .row_sql = "SELECT kind, text FROM event WHERE rowid = ?",
                        .row = event_row,
                        .visit_event = visit,
                        .context = context};
    return walk_table(recording, &walk);
}

enum wb_status wb_recording_each_clock(struct wb_recording *recording,
                                       enum wb_status (*visit)(void *context,
                                                               const struct wb_clock_row *row),
                                       void *context)
{
    struct walk walk = {.table = "clock",
                        .keys_sql = "SELECT rowid, t_host_ns, stream, 0 FROM clock",
                        .row_sql = "SELECT t_device, rtt_ns FROM clock WHERE rowid = ?",
                        .row = clock_row,
                        .visit_clock = visit,
                        .context = context};
    return walk_table(recording, &walk);
}
