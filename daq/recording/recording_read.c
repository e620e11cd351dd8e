/* Reading of recordings: opens a file as far as possible and walks its tables. */
#include "daq/recording/recording.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"
#include "daq/recording/recording_private.h"

#define WB_LOG_DOMAIN "recording"

/* --- the header of the file --- */

#define HEADER_BYTES 100

bool wb_recording_needs_log(const uint8_t *file, size_t n)
{
    return n >= HEADER_BYTES && memcmp(file, "SQLite format 3", 16) == 0 &&
           (file[18] == 2 || file[19] == 2);
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
    if (wb_recording_big_endian(header + 68) != WB_RECORDING_APPLICATION_ID)
        return wb_fail_also(recording->why, WB_ERR_FORMAT,
                            "'%s' is not a recording but an SQLite database of another program",
                            recording->path);
    const uint32_t version = wb_recording_big_endian(header + 60);
    if (version == 0)
        return wb_fail_also(recording->why, WB_ERR_DATA, "'%s' is damaged: its schema number is 0",
                            recording->path);
    if (version > WB_RECORDING_SCHEMA)
        return wb_fail_also(
            recording->why, WB_ERR_UNSUPPORTED,
            "'%s' has schema %u, but this program supports schemas up to %d: use a newer wirebench",
            recording->path, version, WB_RECORDING_SCHEMA);
    recording->schema = (int)version;
    recording->is_log_missing = wb_recording_needs_log(header, sizeof header);
    int64_t page = (int64_t)header[16] << 8 | header[17];
    if (page == 1)
        page = 65536;
    recording->bytes_there = there.st_size;
    recording->bytes_expected = page * (int64_t)wb_recording_big_endian(header + 28);
    if (there.st_size < recording->bytes_expected)
        recording->shortened = true;
    /* A row takes more than four bytes. */
    recording->n_rows_max = there.st_size / 4 + 64;
    return WB_OK;
}

/* --- opening --- */

static char *make_uri(const char *path, const char *options)
{
    /* '%', '?' and '#' are special in the path of a URI. */
    char *const uri = wb_memory_new(3 * strlen(path) + strlen(options) + 16, 1);
    char *to = uri + sprintf(uri, "file:");
    /* After two slashes SQLite would expect a host. */
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

/* Opens the database and reads its schema, because SQLite reads nothing when opening. */
static int open_database(struct wb_recording *recording, const char *path, const char *options)
{
    char *const uri = make_uri(path, options);
    int code = sqlite3_open_v2(uri, &recording->db,
                               SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, NULL);
    free(uri);
    if (code == SQLITE_OK) {
        sqlite3 *db = recording->db;
        sqlite3_extended_result_codes(db, 1);
        sqlite3_busy_timeout(db, 2000);
        /* SQLite rejects a truncated file unless its schema is writable. No code in the schema of
         * an untrusted file is executed. */
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

/* Opens a copy of an unclosed recording and its write-ahead log, for folders where SQLite cannot
 * create its index of the log. */
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

/* Counts the frames of the log: SQLite silently ignores all frames after a damaged one. */
static void inspect_log(struct wb_recording *recording, const char *wal)
{
    char *bytes = NULL;
    size_t size = 0;
    struct wb_reason unread = {{0}}; /* ignored: SQLite will report the same error */
    if (wb_file_read_with_reason(wal, &bytes, &size, &unread) == WB_OK)
        wb_recording_log_count((const uint8_t *)bytes, size, &recording->log);
    free(bytes);
}

static enum wb_status open_plain(struct wb_recording *recording)
{
    char wal[WB_PATH];
    int n = snprintf(wal, sizeof wal, "%s-wal", recording->path);
    struct stat there;
    if (n < 0 || (size_t)n >= sizeof wal || stat(wal, &there) != 0) {
        /* A closed file is never written again: no locks and no auxiliary files are needed. */
        int code = open_database(recording, recording->path, "immutable=1");
        return code == SQLITE_OK ? WB_OK : wb_recording_fail(recording, code, "open the recording");
    }
    recording->n_rows_max += there.st_size / 4;
    recording->is_log_missing &= there.st_size == 0;
    inspect_log(recording, wal);
    recording->shortened = false; /* the log may hold the pages that the header counts */
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
    recording->uncompressed = to;
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

/* False if a problem of this table was reported before. */
static bool is_first_report(struct wb_recording *recording, enum wb_recording_kind kind)
{
    const bool is_first = !recording->is_reported[kind];
    recording->is_reported[kind] = true;
    return is_first;
}

static enum wb_status report_damaged(struct wb_recording *recording, enum wb_recording_kind kind,
                                     size_t n)
{
    if (!is_first_report(recording, kind))
        return WB_ERR_DATA;
    return wb_fail_also(recording->why, WB_ERR_DATA, "'%s': %zu row%s of table %s %s damaged",
                        recording->path, n, n == 1 ? "" : "s", wb_recording_tables[kind].name,
                        n == 1 ? "is" : "are");
}

/* Status at the end of a walk: reports missing rows. */
static enum wb_status end_walk(struct wb_recording *recording,
                               const struct wb_recording_cursor *cursor)
{
    if (cursor->code == SQLITE_DONE)
        return WB_OK;
    if ((cursor->code & 0xff) == SQLITE_NOMEM)
        return wb_recording_fail(recording, cursor->code, "read");
    /* A truncated file was reported on opening, and every table is walked twice. */
    if (recording->shortened || !is_first_report(recording, cursor->kind))
        return WB_ERR_DATA;
    const int64_t after = cursor->n_rows - cursor->n_rows_before;
    char behind[64] = "";
    if (after > 0)
        snprintf(behind, sizeof behind, "; %lld more after the damage", (long long)after);
    return wb_fail_also(
        recording->why, WB_ERR_DATA, "'%s': table %s is damaged after %lld row%s: %s%s",
        recording->path, wb_recording_tables[cursor->kind].name, (long long)cursor->n_rows_before,
        cursor->n_rows_before == 1 ? "" : "s", sqlite3_errstr(cursor->code), behind);
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

static const char *text_of(const struct wb_recording_value *value)
{
    return value->bytes; /* SQLite ends texts with a NUL */
}

static enum wb_status read_stream_row(struct wb_recording *recording,
                                      const struct wb_recording_row *row)
{
    const struct wb_recording_value *const v = row->values;
    struct wb_recording_stream stream = {.id = (int)v[0].integer};
    if (!row->intact && recording->schema >= 2)
        return wb_fail_also(recording->why, WB_ERR_DATA,
                            "'%s': the row of a stream is damaged; the stream is skipped",
                            recording->path);
    if (!role_of(text_of(&v[1]), &stream.role)) {
        wb_warn("'%s': stream %d has the unknown role '%.40s' and is skipped", recording->path,
                stream.id, text_of(&v[1]));
        return WB_OK;
    }
    snprintf(stream.address, sizeof stream.address, "%s", text_of(&v[2]));
    snprintf(stream.protocol, sizeof stream.protocol, "%s", text_of(&v[3]));
    return wb_recording_remember_stream(recording, &stream, text_of(&v[4]));
}

static enum wb_status read_streams(struct wb_recording *recording)
{
    struct wb_recording_cursor cursor;
    struct wb_recording_row row;
    WB_TRY(wb_recording_cursor_open(&cursor, recording, WB_RECORDING_STREAM, NULL, true));
    enum wb_status status = WB_OK;
    while (status != WB_ERR_MEMORY && cursor.n_rows < 1000 && wb_recording_cursor_step(&cursor)) {
        wb_recording_read_row(&cursor, &row);
        status =
            read_stream_row(recording, &row); /* after reported damage the rest is still used */
    }
    if (status != WB_ERR_MEMORY)
        status = end_walk(recording, &cursor);
    wb_recording_cursor_close(&cursor);
    return status == WB_ERR_MEMORY ? status : WB_OK;
}

/* Determines the schema from the columns: the number in the header has no checksum. */
static void find_schema(struct wb_recording *recording)
{
    for (int i = 0; i < WB_RECORDING_TABLES; i++) {
        char sql[64];
        sqlite3_stmt *statement = NULL;
        snprintf(sql, sizeof sql, "SELECT chain FROM %s", wb_recording_tables[i].name);
        if (sqlite3_prepare_v2(recording->db, sql, -1, &statement, NULL) == SQLITE_OK)
            recording->schema = WB_RECORDING_SCHEMA;
        sqlite3_finalize(statement);
    }
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
    struct wb_recording *const recording = wb_memory_new(1, sizeof *recording);
    recording->why = why;
    recording->uncompressed = -1;
    recording->path = wb_memory_text(path);
    enum wb_status status = open_any(recording, descriptor);
    close(descriptor);
    if (status == WB_OK) {
        find_schema(recording);
        status = read_streams(recording);
    }
    if (status != WB_OK) {
        wb_recording_release(recording);
        return status;
    }
    char *closed = NULL;
    const char *const last = recording->schema >= 2 ? WB_RECORDING_DIGEST : "closed";
    recording->complete =
        wb_recording_meta(recording, last, &closed) == WB_OK && !recording->shortened;
    free(closed);
    *out = recording;
    return WB_OK;
}

enum wb_status wb_recording_hash(const struct wb_recording *recording, char hex[65])
{
    return recording->uncompressed >= 0
               ? wb_hash_descriptor(recording->uncompressed, recording->path, hex, recording->why)
               : wb_recording_sha256(recording->path, hex, recording->why);
}

bool wb_recording_log_problem(const struct wb_recording *recording, char *text, size_t size)
{
    const struct wb_recording_log *const log = &recording->log;
    /* During closing, after the digest was written, the log is no longer needed. */
    if (recording->is_log_missing && !recording->complete) {
        snprintf(
            text, size,
            "it was not closed, and its write-ahead log '%.60s-wal' is missing, which contains the "
            "last second or more of the recording: restore that file",
            wb_file_name(recording->path));
        return true;
    }
    if (log->readable >= log->frames)
        return false;
    snprintf(text, size,
             "its write-ahead log '%.60s-wal' is damaged: %llu of its %llu pages are read; run "
             "`wirebench recover` to read the intact rest",
             wb_file_name(recording->path), (unsigned long long)log->readable,
             (unsigned long long)log->frames);
    return true;
}

void wb_recording_warn_cut_short(const struct wb_recording *recording)
{
    char problem[240];
    if (wb_recording_log_problem(recording, problem, sizeof problem))
        wb_warn("'%s': %s", recording->path, problem);
    if (recording->shortened)
        wb_warn("'%s' is truncated: %.1f of %.1f MB could be read; use the original file%s",
                recording->path, (double)recording->bytes_there * 1e-6,
                (double)recording->bytes_expected * 1e-6,
                recording->compressed ? "" : ", or restore its -wal file");
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

struct meta {
    char *key, *value;
};

struct metas {
    struct meta *items;
    size_t n, capacity;
};

static void release_metas(struct metas *metas)
{
    for (size_t i = 0; i < metas->n; i++) {
        free(metas->items[i].key);
        free(metas->items[i].value);
    }
    free(metas->items);
}

static int compare_metas(const void *a, const void *b)
{
    return strcmp(((const struct meta *)a)->key, ((const struct meta *)b)->key);
}

/* Adds a meta value; of a key that was set twice, the later value is kept. */
static void add_meta(struct metas *metas, const char *key, const char *value)
{
    size_t i = 0;
    while (i < metas->n && strcmp(metas->items[i].key, key) != 0)
        i++;
    if (i == metas->n) {
        metas->items =
            wb_memory_room(metas->items, &metas->capacity, ++metas->n, sizeof *metas->items);
        metas->items[i] = (struct meta){.key = wb_memory_text(key)};
    }
    free(metas->items[i].value);
    metas->items[i].value = wb_memory_text(value);
}

/* Reads all meta values, or only that of one key, in no order. WB_ERR_DATA: some cannot be read,
 * all others are in `metas`. */
static enum wb_status read_metas(struct wb_recording *recording, const char *key,
                                 struct metas *metas)
{
    struct wb_recording_cursor cursor;
    struct wb_recording_row row;
    WB_TRY(wb_recording_cursor_open(&cursor, recording, WB_RECORDING_META, NULL, true));
    size_t n_damaged = 0;
    while (wb_recording_cursor_step(&cursor)) {
        wb_recording_read_row(&cursor, &row);
        const char *const name = text_of(&row.values[0]);
        if (recording->schema >= 2 && !row.intact)
            n_damaged++;
        else if (!key || strcmp(name, key) == 0)
            add_meta(metas, name, text_of(&row.values[1]));
    }
    enum wb_status status = end_walk(recording, &cursor);
    if (status == WB_OK && n_damaged > 0)
        status = report_damaged(recording, WB_RECORDING_META, n_damaged);
    wb_recording_cursor_close(&cursor);
    return status;
}

enum wb_status wb_recording_meta(struct wb_recording *recording, const char *key, char **value)
{
    struct metas metas = {0};
    enum wb_status status = read_metas(recording, key, &metas);
    if (status == WB_OK && metas.n == 0)
        status = WB_ERR_NOT_FOUND;
    if (metas.n > 0 && status != WB_ERR_MEMORY) {
        *value = metas.items[0].value;
        metas.items[0].value = NULL;
        status = WB_OK;
    }
    release_metas(&metas);
    return status;
}

enum wb_status wb_recording_each_meta(struct wb_recording *recording,
                                      enum wb_status (*visit)(void *context, const char *key,
                                                              const char *value),
                                      void *context)
{
    struct metas metas = {0};
    const enum wb_status end = read_metas(recording, NULL, &metas);
    enum wb_status status = end == WB_ERR_MEMORY ? end : WB_OK;
    if (metas.n > 1)
        qsort(metas.items, metas.n, sizeof metas.items[0], compare_metas);
    for (size_t i = 0; i < metas.n && status == WB_OK; i++)
        status = visit(context, metas.items[i].key, metas.items[i].value);
    release_metas(&metas);
    return status != WB_OK ? status : end;
}

/* --- rows in order of time --- */

/* Number and sorting keys of a row. Sorting keys here, instead of rows in SQLite, gives all
 * readable rows of a damaged file and needs little memory. */
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

/* Reads rowid, time, stream and seq of all readable rows. *end is WB_OK, or the reason why rows are
 * missing. Rows of a truncated page have no time and are skipped. */
static enum wb_status read_keys(struct wb_recording *recording, enum wb_recording_kind kind,
                                const char *columns, struct keys *keys, enum wb_status *end)
{
    struct wb_recording_cursor cursor;
    WB_TRY(wb_recording_cursor_open(&cursor, recording, kind, columns, true));
    while (wb_recording_cursor_step(&cursor)) {
        sqlite3_stmt *const statement = cursor.statement;
        if (sqlite3_column_type(statement, 1) != SQLITE_INTEGER) {
            wb_recording_cursor_break(&cursor, SQLITE_CORRUPT);
            continue;
        }
        keys->items =
            wb_memory_room(keys->items, &keys->capacity, keys->n + 1, sizeof *keys->items);
        keys->items[keys->n++] = (struct key){.rowid = sqlite3_column_int64(statement, 0),
                                              .t_ns = sqlite3_column_int64(statement, 1),
                                              .stream = sqlite3_column_int(statement, 2),
                                              .seq = sqlite3_column_int64(statement, 3)};
    }
    *end = end_walk(recording, &cursor);
    wb_recording_cursor_close(&cursor);
    return WB_OK;
}

/* A table to be walked: its keys, the index of the time among a row's values, and the visitor. */
struct walk {
    enum wb_recording_kind kind;
    const char *keys; /* rowid, time, stream, seq */
    int time;
    enum wb_status (*row)(struct walk *walk, const struct wb_recording_row *row);
    enum wb_status (*visit_chunk)(void *, const struct wb_chunk *);
    enum wb_status (*visit_event)(void *, const struct wb_event *);
    enum wb_status (*visit_clock)(void *, const struct wb_clock_row *);
    void *context;
};

/* Whether the row is to be visited. Damaged chunks are visited, because visitors can see that they
 * are damaged. The number of a damaged row may lead to another row. */
static bool is_good(const struct walk *walk, const struct key *key,
                    const struct wb_recording_row *row, int schema)
{
    return row->number == key->rowid && row->values[walk->time].integer == key->t_ns &&
           (row->intact || walk->kind == WB_RECORDING_CHUNK || schema < 2);
}

/* Visits the rows; those that cannot be read are skipped and counted in *n_lost. */
static enum wb_status visit_rows(struct wb_recording *recording, struct walk *walk,
                                 const struct keys *keys, size_t *n_lost)
{
    struct wb_recording_cursor cursor;
    WB_TRY(wb_recording_cursor_open(&cursor, recording, walk->kind, NULL, true));
    sqlite3_stmt *const statement = cursor.statement;
    enum wb_status status = WB_OK;
    for (size_t i = 0; i < keys->n && status == WB_OK; i++) {
        struct wb_recording_row row;
        sqlite3_reset(statement);
        sqlite3_bind_int64(statement, 1, keys->items[i].rowid);
        int code = sqlite3_step(statement);
        if (code == SQLITE_ROW)
            wb_recording_read_row(&cursor, &row);
        if (code == SQLITE_ROW && is_good(walk, &keys->items[i], &row, recording->schema))
            status = walk->row(walk, &row);
        else if ((code & 0xff) == SQLITE_NOMEM)
            status = wb_recording_fail(recording, code, "read");
        else
            ++*n_lost;
    }
    wb_recording_cursor_close(&cursor);
    return status;
}

static enum wb_status walk_table(struct wb_recording *recording, struct walk *walk)
{
    struct keys keys = {0};
    enum wb_status end = WB_OK;
    enum wb_status status = read_keys(recording, walk->kind, walk->keys, &keys, &end);
    if (status == WB_OK) {
        bool sorted = true;
        for (size_t i = 1; i < keys.n && sorted; i++)
            sorted = compare_keys(&keys.items[i - 1], &keys.items[i]) <= 0;
        if (!sorted)
            qsort(keys.items, keys.n, sizeof keys.items[0], compare_keys);
        size_t n_lost = 0;
        status = visit_rows(recording, walk, &keys, &n_lost);
        if (status == WB_OK && end == WB_OK && n_lost > 0)
            end =
                recording->shortened ? WB_ERR_DATA : report_damaged(recording, walk->kind, n_lost);
    }
    free(keys.items);
    return status != WB_OK ? status : end;
}

static enum wb_status chunk_row(struct walk *walk, const struct wb_recording_row *row)
{
    const struct wb_recording_value *const v = row->values;
    const struct wb_chunk chunk = {.stream = (int)v[0].integer,
                                   .seq = v[1].integer,
                                   .t_ns = v[2].integer,
                                   .bytes = v[WB_RECORDING_CHUNK_BYTES].bytes,
                                   .n = v[WB_RECORDING_CHUNK_BYTES].n,
                                   .intact = row->intact};
    return walk->visit_chunk(walk->context, &chunk);
}

static enum wb_status event_row(struct walk *walk, const struct wb_recording_row *row)
{
    const struct wb_recording_value *const v = row->values;
    struct wb_event event = {.t_ns = v[0].integer};
    snprintf(event.kind, sizeof event.kind, "%s", text_of(&v[1]));
    snprintf(event.text, sizeof event.text, "%s", text_of(&v[2]));
    return walk->visit_event(walk->context, &event);
}

static enum wb_status clock_row(struct walk *walk, const struct wb_recording_row *row)
{
    const struct wb_recording_value *const v = row->values;
    const struct wb_clock_row clock = {.stream = (int)v[0].integer,
                                       .t_host_ns = v[1].integer,
                                       .t_device = v[2].real,
                                       .rtt_ns = v[3].integer};
    return walk->visit_clock(walk->context, &clock);
}

enum wb_status wb_recording_each_chunk(struct wb_recording *recording,
                                       enum wb_status (*visit)(void *context,
                                                               const struct wb_chunk *chunk),
                                       void *context)
{
    struct walk walk = {.kind = WB_RECORDING_CHUNK,
                        .keys = "rowid, t_ns, stream, seq",
                        .time = 2,
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
    struct walk walk = {.kind = WB_RECORDING_EVENT,
                        .keys = "rowid, t_ns, 0, 0",
                        .time = 0,
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
    struct walk walk = {.kind = WB_RECORDING_CLOCK,
                        .keys = "rowid, t_host_ns, stream, 0",
                        .time = 1,
                        .row = clock_row,
                        .visit_clock = visit,
                        .context = context};
    return walk_table(recording, &walk);
}
