/* Recordings being written: schema, appends in transactions, closing. */
#include "daq/recording.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "daq/recording_private.h"

#define WB_LOG_DOMAIN "recording"

/* A rowid table each: chunks are appended in order of arrival, so that the file is written and
 * read from front to back. `crc32` is zlib's CRC-32 of `bytes`. */
static const char schema[] =
    "CREATE TABLE meta(key TEXT PRIMARY KEY NOT NULL, value TEXT NOT NULL);"
    "CREATE TABLE stream(id INTEGER PRIMARY KEY NOT NULL, role TEXT NOT NULL,"
    " address TEXT NOT NULL, protocol TEXT NOT NULL, settings TEXT NOT NULL);"
    "CREATE TABLE chunk(stream INTEGER NOT NULL REFERENCES stream(id), seq INTEGER NOT NULL,"
    " t_ns INTEGER NOT NULL, bytes BLOB NOT NULL, crc32 INTEGER NOT NULL);"
    "CREATE TABLE event(t_ns INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL);"
    "CREATE TABLE clock(stream INTEGER NOT NULL REFERENCES stream(id),"
    " t_host_ns INTEGER NOT NULL, t_device REAL, rtt_ns INTEGER NOT NULL);";

enum wb_status wb_recording_fail(const struct wb_recording *recording, int code, const char *doing)
{
    const char *path = recording->path;
    /* SQLite keeps the system's reason for some failures only; the others leave it in errno. */
    int error = recording->db ? sqlite3_system_errno(recording->db) : 0;
    if (error == 0)
        error = errno;
    switch (code & 0xff) {
    case SQLITE_FULL:
        return wb_fail_also(recording->why, WB_ERR_IO, "'%s': cannot %s: the disk is full", path,
                            doing);
    case SQLITE_NOMEM:
        return wb_fail_also(recording->why, WB_ERR_MEMORY, "'%s': cannot %s: out of memory", path,
                            doing);
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
        return wb_fail_also(recording->why, WB_ERR_DATA, "'%s': cannot %s: the database is damaged",
                            path, doing);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return wb_fail_also(recording->why, WB_ERR_BUSY,
                            "'%s': cannot %s: another program holds it", path, doing);
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
        return wb_fail_also(recording->why, WB_ERR_PERMISSION, "'%s': cannot %s: not allowed", path,
                            doing);
    default:
        break;
    }
    if (error == EFBIG)
        return wb_fail_also(recording->why, WB_ERR_IO,
                            "'%s': cannot %s: the largest file size allowed is reached", path,
                            doing);
    return wb_fail_also(recording->why, WB_ERR_IO, "'%s': cannot %s: %s%s%s", path, doing,
                        sqlite3_errstr(code), error ? ": " : "", error ? strerror(error) : "");
}

uint32_t wb_recording_crc32(const void *bytes, size_t n)
{
    return (uint32_t)crc32_z(crc32_z(0, NULL, 0), bytes, n);
}

enum wb_status wb_recording_remember_stream(struct wb_recording *recording,
                                            const struct wb_recording_stream *stream,
                                            const char *settings)
{
    size_t n = (size_t)recording->n_streams + 1;
    struct wb_recording_stream *streams = realloc(recording->streams, n * sizeof *streams);
    if (streams)
        recording->streams = streams;
    char **texts = realloc(recording->settings, n * sizeof *texts);
    if (texts)
        recording->settings = texts;
    char *copy = strdup(settings);
    if (!streams || !texts || !copy) {
        free(copy);
        return wb_fail_also(recording->why, WB_ERR_MEMORY, "out of memory for the streams of '%s'",
                            recording->path);
    }
    streams[n - 1] = *stream;
    texts[n - 1] = copy;
    recording->n_streams = (int)n;
    return WB_OK;
}

void wb_recording_release(struct wb_recording *recording)
{
    sqlite3_finalize(recording->insert_chunk);
    sqlite3_finalize(recording->insert_event);
    sqlite3_finalize(recording->insert_clock);
    sqlite3_finalize(recording->insert_meta);
    sqlite3_finalize(recording->insert_stream);
    sqlite3_close(recording->db);
    for (int i = 0; i < recording->n_streams; i++)
        free(recording->settings[i]);
    free(recording->settings);
    free(recording->streams);
    free(recording->path);
    free(recording);
}

/* Makes the empty file ourselves: SQLite would open an existing one. Left-over journals of an
 * earlier file of this name would be taken for ours. */
static enum wb_status make_file(const char *path)
{
    static const char *const beside[] = {"-wal", "-journal", "-shm"};
    for (size_t i = 0; i < sizeof beside / sizeof beside[0]; i++) {
        char other[4096];
        int n = snprintf(other, sizeof other, "%s%s", path, beside[i]);
        if (n < 0 || (size_t)n >= sizeof other)
            return wb_fail(WB_ERR_ARGUMENT, "path '%.100s...' is too long", path);
        if (access(other, F_OK) == 0)
            return wb_fail(WB_ERR_EXISTS,
                           "'%s' exists: it is part of an earlier recording of this name; choose "
                           "another name",
                           other);
    }
    int descriptor = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
        close(descriptor);
        return WB_OK;
    }
    if (errno == EEXIST)
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' exists: a recording is never overwritten; choose another name", path);
    char folder[WB_PATH];
    const int error = errno;
    wb_file_folder(folder, path);
    if (error == ENOENT && wb_file_is_folder(folder)) /* /proc and the like */
        return wb_fail(WB_ERR_PERMISSION, "'%s' cannot be made: nothing can be written in '%s'",
                       path, folder);
    errno = error;
    if (errno == ENOENT || errno == ENOTDIR)
        return wb_fail(WB_ERR_NOT_FOUND, "'%s' cannot be made: its folder does not exist", path);
    return wb_fail(errno == EACCES || errno == EROFS ? WB_ERR_PERMISSION : WB_ERR_IO,
                   "'%s' cannot be made: %s", path, strerror(errno));
}

static enum wb_status prepare(struct wb_recording *recording)
{
    static const struct {
        size_t offset;
        const char *sql;
    } statements[] = {
        {offsetof(struct wb_recording, insert_chunk), "INSERT INTO chunk VALUES(?,?,?,?,?)"},
        {offsetof(struct wb_recording, insert_event), "INSERT INTO event VALUES(?,?,?)"},
        {offsetof(struct wb_recording, insert_clock), "INSERT INTO clock VALUES(?,?,?,?)"},
        {offsetof(struct wb_recording, insert_meta), "INSERT OR REPLACE INTO meta VALUES(?,?)"},
        {offsetof(struct wb_recording, insert_stream), "INSERT INTO stream VALUES(?,?,?,?,?)"},
    };
    for (size_t i = 0; i < sizeof statements / sizeof statements[0]; i++) {
        sqlite3_stmt **target = (sqlite3_stmt **)((char *)recording + statements[i].offset);
        int code = sqlite3_prepare_v3(recording->db, statements[i].sql, -1,
                                      SQLITE_PREPARE_PERSISTENT, target, NULL);
        if (code != SQLITE_OK)
            return wb_recording_fail(recording, code, "prepare the recording");
    }
    return WB_OK;
}

/* The schema is written before WAL is switched on, so that the main file says from the start what
 * it is. FULL makes a flush survive a power cut; the writer thread bears the wait. */
static enum wb_status set_up(struct wb_recording *recording)
{
    char pragmas[256];
    snprintf(pragmas, sizeof pragmas,
             "PRAGMA page_size=4096; PRAGMA application_id=%d; PRAGMA user_version=%d; BEGIN;",
             WB_RECORDING_APPLICATION_ID, WB_RECORDING_SCHEMA);
    int code = sqlite3_exec(recording->db, pragmas, NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_exec(recording->db, schema, NULL, NULL, NULL);
    if (code == SQLITE_OK)
        code =
            sqlite3_exec(recording->db, "COMMIT; PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL;",
                         NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return wb_recording_fail(recording, code, "set up the recording");
    return prepare(recording);
}

enum wb_status wb_recording_create(struct wb_recording **out, const char *path)
{
    *out = NULL;
    WB_TRY(make_file(path));
    struct wb_recording *recording = calloc(1, sizeof *recording);
    if (recording)
        recording->path = strdup(path);
    if (!recording || !recording->path) {
        free(recording);
        unlink(path);
        return wb_fail(WB_ERR_MEMORY, "out of memory for '%s'", path);
    }
    recording->writing = true;
    int code =
        sqlite3_open_v2(path, &recording->db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL);
    enum wb_status status = WB_OK;
    if (code != SQLITE_OK) {
        status = wb_recording_fail(recording, code, "create the recording");
    } else {
        sqlite3_extended_result_codes(recording->db, 1);
        /* Somebody looking on (`info`) may hold a lock for a moment. */
        sqlite3_busy_timeout(recording->db, 5000);
        status = set_up(recording);
    }
    if (status != WB_OK) {
        wb_recording_release(recording);
        unlink(path);
        return status;
    }
    *out = recording;
    return WB_OK;
}

/* Remembers the first error of a write and gives up the open transaction. */
static enum wb_status latch(struct wb_recording *recording, enum wb_status status)
{
    recording->failed = status;
    if (recording->in_transaction)
        sqlite3_exec(recording->db, "ROLLBACK", NULL, NULL, NULL);
    recording->in_transaction = false;
    return status;
}

static enum wb_status begin(struct wb_recording *recording)
{
    if (!recording->writing)
        return wb_fail(WB_ERR_ARGUMENT, "'%s' is open for reading only", recording->path);
    if (recording->failed != WB_OK || recording->in_transaction)
        return recording->failed;
    int code = sqlite3_exec(recording->db, "BEGIN", NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return latch(recording, wb_recording_fail(recording, code, "write"));
    recording->in_transaction = true;
    return WB_OK;
}

/* Runs a prepared insert. A constraint is the caller's mistake (a stream declared twice) and spoils
 * nothing; everything else is latched. */
static enum wb_status insert(struct wb_recording *recording, sqlite3_stmt *statement)
{
    errno = 0;
    int code = sqlite3_step(statement);
    int error = errno;
    sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
    errno = error;
    if (code == SQLITE_DONE)
        return WB_OK;
    if ((code & 0xff) == SQLITE_CONSTRAINT)
        return wb_fail(WB_ERR_ARGUMENT, "'%s': a row breaks the schema: %s", recording->path,
                       sqlite3_errmsg(recording->db));
    return latch(recording, wb_recording_fail(recording, code, "write"));
}

enum wb_status wb_recording_set_meta(struct wb_recording *recording, const char *key,
                                     const char *value)
{
    WB_TRY(begin(recording));
    sqlite3_stmt *statement = recording->insert_meta;
    sqlite3_bind_text(statement, 1, key, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 2, value, -1, SQLITE_STATIC);
    return insert(recording, statement);
}

enum wb_status wb_recording_add_stream(struct wb_recording *recording, enum wb_role role,
                                       const char *address, const char *protocol,
                                       const char *settings, int *id)
{
    WB_TRY(begin(recording));
    struct wb_recording_stream stream = {.id = recording->n_streams, .role = role};
    snprintf(stream.address, sizeof stream.address, "%s", address);
    snprintf(stream.protocol, sizeof stream.protocol, "%s", protocol);
    sqlite3_stmt *statement = recording->insert_stream;
    sqlite3_bind_int(statement, 1, stream.id);
    sqlite3_bind_text(statement, 2, wb_role_name(role), -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 3, stream.address, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 4, stream.protocol, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 5, settings ? settings : "", -1, SQLITE_STATIC);
    WB_TRY(insert(recording, statement));
    WB_TRY(wb_recording_remember_stream(recording, &stream, settings ? settings : ""));
    *id = stream.id;
    return WB_OK;
}

enum wb_status wb_recording_append_chunk(struct wb_recording *recording, int stream, int64_t seq,
                                         int64_t t_ns, const void *bytes, size_t n)
{
    WB_TRY(begin(recording));
    if (stream < 0 || stream >= recording->n_streams)
        return wb_fail(WB_ERR_ARGUMENT, "'%s' has no stream %d", recording->path, stream);
    sqlite3_stmt *statement = recording->insert_chunk;
    sqlite3_bind_int(statement, 1, stream);
    sqlite3_bind_int64(statement, 2, seq);
    sqlite3_bind_int64(statement, 3, t_ns);
    /* A NULL pointer would bind SQL NULL. */
    sqlite3_bind_blob64(statement, 4, n ? bytes : "", n, SQLITE_STATIC);
    sqlite3_bind_int64(statement, 5, (sqlite3_int64)wb_recording_crc32(n ? bytes : "", n));
    return insert(recording, statement);
}

enum wb_status wb_recording_append_event(struct wb_recording *recording, int64_t t_ns,
                                         const char *kind, const char *text)
{
    WB_TRY(begin(recording));
    sqlite3_stmt *statement = recording->insert_event;
    sqlite3_bind_int64(statement, 1, t_ns);
    sqlite3_bind_text(statement, 2, kind, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 3, text, -1, SQLITE_STATIC);
    return insert(recording, statement);
}

enum wb_status wb_recording_append_clock(struct wb_recording *recording, int stream,
                                         int64_t t_host_ns, double t_device, int64_t rtt_ns)
{
    WB_TRY(begin(recording));
    sqlite3_stmt *statement = recording->insert_clock;
    sqlite3_bind_int(statement, 1, stream);
    sqlite3_bind_int64(statement, 2, t_host_ns);
    sqlite3_bind_double(statement, 3, t_device); /* NaN becomes NULL */
    sqlite3_bind_int64(statement, 4, rtt_ns);
    return insert(recording, statement);
}

enum wb_status wb_recording_flush(struct wb_recording *recording)
{
    if (recording->failed != WB_OK || !recording->in_transaction)
        return recording->failed;
    errno = 0;
    int code = sqlite3_exec(recording->db, "COMMIT", NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return latch(recording, wb_recording_fail(recording, code, "write"));
    recording->in_transaction = false;
    return WB_OK;
}

/* One plain file, readable from a read-only folder. */
static enum wb_status finish_file(struct wb_recording *recording)
{
    char now[32];
    time_t seconds = time(NULL);
    struct tm utc;
    gmtime_r(&seconds, &utc);
    strftime(now, sizeof now, "%Y-%m-%dT%H:%M:%SZ", &utc);
    WB_TRY(wb_recording_set_meta(recording, "closed", now));
    WB_TRY(wb_recording_flush(recording));
    int code =
        sqlite3_wal_checkpoint_v2(recording->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
    if (code != SQLITE_OK)
        return wb_recording_fail(recording, code, "bring the recording into one file");
    code = sqlite3_exec(recording->db, "PRAGMA journal_mode=DELETE", NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return wb_recording_fail(recording, code, "bring the recording into one file");
    return WB_OK;
}

enum wb_status wb_recording_close(struct wb_recording *recording)
{
    if (!recording)
        return WB_OK;
    enum wb_status status = WB_OK;
    if (recording->writing) {
        status = recording->failed;
        if (status == WB_OK)
            status = finish_file(recording);
    }
    wb_recording_release(recording);
    return status;
}
