/* Writing of recordings: schema, appends in transactions, closing. */
#include "base/timing.h"
#include "daq/recording/recording.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/units.h"
#include "daq/recording/recording_private.h"

#define WB_LOG_DOMAIN "recording"

/* Tables have no index: rows are appended in order of arrival, so that the file is written and read
 * sequentially and contains no data twice. */
static const char schema[] =
    "CREATE TABLE meta(n INTEGER PRIMARY KEY, key TEXT NOT NULL, value TEXT NOT NULL,"
    " crc32 INTEGER NOT NULL, chain INTEGER NOT NULL);"
    "CREATE TABLE stream(n INTEGER PRIMARY KEY, id INTEGER NOT NULL, role TEXT NOT NULL,"
    " address TEXT NOT NULL, protocol TEXT NOT NULL, settings TEXT NOT NULL,"
    " crc32 INTEGER NOT NULL, chain INTEGER NOT NULL);"
    "CREATE TABLE chunk(n INTEGER PRIMARY KEY, stream INTEGER NOT NULL, seq INTEGER NOT NULL,"
    " t_ns INTEGER NOT NULL, bytes BLOB NOT NULL, crc32 INTEGER NOT NULL,"
    " chain INTEGER NOT NULL);"
    "CREATE TABLE event(n INTEGER PRIMARY KEY, t_ns INTEGER NOT NULL, kind TEXT NOT NULL,"
    " text TEXT NOT NULL, crc32 INTEGER NOT NULL, chain INTEGER NOT NULL);"
    "CREATE TABLE clock(n INTEGER PRIMARY KEY, stream INTEGER NOT NULL,"
    " t_host_ns INTEGER NOT NULL, t_device REAL, rtt_ns INTEGER NOT NULL,"
    " crc32 INTEGER NOT NULL, chain INTEGER NOT NULL);";

enum wb_status wb_recording_fail(const struct wb_recording *recording, int code, const char *doing)
{
    static const struct {
        int code;
        enum wb_status status;
        const char *problem;
    } causes[] = {
        {SQLITE_FULL, WB_ERR_IO, "the disk is full"},
        {SQLITE_NOMEM, WB_ERR_MEMORY, "out of memory"},
        {SQLITE_CORRUPT, WB_ERR_DATA, "the database is damaged"},
        {SQLITE_NOTADB, WB_ERR_DATA, "the database is damaged"},
        {SQLITE_BUSY, WB_ERR_BUSY, "it is locked by another program"},
        {SQLITE_LOCKED, WB_ERR_BUSY, "it is locked by another program"},
        {SQLITE_READONLY, WB_ERR_PERMISSION, "no permission"},
        {SQLITE_PERM, WB_ERR_PERMISSION, "no permission"},
        {SQLITE_AUTH, WB_ERR_PERMISSION, "no permission"},
    };
    const char *const path = recording->path;
    /* SQLite stores the system's error code for some failures only; for others errno has it. */
    int error = recording->db ? sqlite3_system_errno(recording->db) : 0;
    if (error == 0)
        error = errno;
    for (size_t i = 0; i < sizeof causes / sizeof causes[0]; i++) {
        if (causes[i].code == (code & 0xff))
            return wb_fail_also(recording->why, causes[i].status, "'%s': cannot %s: %s", path,
                                doing, causes[i].problem);
    }
    if (error == EFBIG)
        return wb_fail_also(recording->why, WB_ERR_IO,
                            "'%s': cannot %s: the maximum file size is reached", path, doing);
    return wb_fail_also(recording->why, WB_ERR_IO, "'%s': cannot %s: %s%s%s", path, doing,
                        sqlite3_errstr(code), error ? ": " : "", error ? strerror(error) : "");
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
    for (int i = 0; i < WB_RECORDING_TABLES; i++)
        sqlite3_finalize(recording->insert[i]);
    wb_hash_destroy(recording->digest);
    sqlite3_close(recording->db);
    if (recording->uncompressed >= 0)
        close(recording->uncompressed);
    for (int i = 0; i < recording->n_streams; i++)
        free(recording->settings[i]);
    free(recording->settings);
    free(recording->streams);
    free(recording->unflushed);
    free(recording->path);
    free(recording);
}

/* Creates the empty file here, because SQLite would open an existing one. Remaining journals of an
 * earlier file of this name are an error: SQLite would use them. */
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
                           "'%s' exists and belongs to an earlier recording of this name: choose "
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
                       "'%s' exists: recordings are never overwritten; choose another name", path);
    char folder[WB_PATH];
    const int error = errno;
    wb_file_folder(folder, path);
    if (error == ENOENT && wb_file_is_folder(folder)) /* /proc and the like */
        return wb_fail(WB_ERR_PERMISSION, "'%s' cannot be created: no files can be written in '%s'",
                       path, folder);
    if (error == ENOENT || error == ENOTDIR)
        return wb_fail(WB_ERR_NOT_FOUND, "'%s' cannot be created: its folder does not exist", path);
    return wb_fail(error == EACCES || error == EROFS ? WB_ERR_PERMISSION : WB_ERR_IO,
                   "'%s' cannot be created: %s", path, strerror(error));
}

static enum wb_status prepare(struct wb_recording *recording)
{
    for (int i = 0; i < WB_RECORDING_TABLES; i++) {
        const struct wb_recording_table *const table = &wb_recording_tables[i];
        char sql[200];
        /* In addition to the row's values: its number, its checksum and the chain. */
        snprintf(sql, sizeof sql, "INSERT INTO %s(n, %s, crc32, chain) VALUES(?, ?, ?%.*s)",
                 table->name, table->columns, 3 * (int)strlen(table->types), ", ?, ?, ?, ?, ?");
        const int code = sqlite3_prepare_v3(recording->db, sql, -1, SQLITE_PREPARE_PERSISTENT,
                                            &recording->insert[i], NULL);
        if (code != SQLITE_OK)
            return wb_recording_fail(recording, code, "prepare the recording");
    }
    return WB_OK;
}

/* The schema is written before WAL is enabled, so that the main file is always a valid recording.
 * With synchronous=FULL a flush survives a power cut; only the writer thread waits for it. */
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
    if (recording) {
        recording->uncompressed = -1;
        recording->path = strdup(path);
    }
    if (!recording || !recording->path) {
        free(recording);
        unlink(path);
        return wb_fail(WB_ERR_MEMORY, "out of memory for '%s'", path);
    }
    recording->writing = true;
    recording->schema = WB_RECORDING_SCHEMA;
    recording->digest = wb_hash_create();
    int code =
        sqlite3_open_v2(path, &recording->db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL);
    enum wb_status status = WB_OK;
    if (code != SQLITE_OK) {
        status = wb_recording_fail(recording, code, "create the recording");
    } else {
        sqlite3_extended_result_codes(recording->db, 1);
        /* A reader such as `info` may hold a lock for a moment. */
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

/* Rolls back the open transaction, thus all rows since the last flush. Only the first of several
 * failures is logged. */
static enum wb_status roll_back(struct wb_recording *recording, int code)
{
    if (recording->failed == WB_OK)
        recording->failed = wb_recording_fail(recording, code, "write");
    if (recording->in_transaction)
        sqlite3_exec(recording->db, "ROLLBACK", NULL, NULL, NULL);
    recording->in_transaction = false;
    recording->n_rows -= (int64_t)recording->n_unflushed;
    recording->chain = recording->flushed_chain;
    recording->n_unflushed = 0;
    return recording->failed;
}

/* Stores a row's CRC-32, which enters the digest when the row is flushed. */
static bool remember_row(struct wb_recording *recording, uint32_t crc32)
{
    if (recording->n_unflushed == recording->capacity) {
        const size_t capacity = recording->capacity ? 2 * recording->capacity : 1024;
        uint32_t *const larger = realloc(recording->unflushed, capacity * sizeof *larger);
        if (!larger)
            return false;
        recording->unflushed = larger;
        recording->capacity = capacity;
    }
    recording->unflushed[recording->n_unflushed++] = crc32;
    return true;
}

static enum wb_status begin(struct wb_recording *recording)
{
    if (!recording->writing)
        return wb_fail(WB_ERR_ARGUMENT, "'%s' is open for reading only", recording->path);
    if (recording->in_transaction)
        return WB_OK;
    int code = sqlite3_exec(recording->db, "BEGIN", NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return roll_back(recording, code);
    recording->in_transaction = true;
    return WB_OK;
}

static void bind(sqlite3_stmt *statement, int column, char type,
                 const struct wb_recording_value *value)
{
    switch (type) {
    case 'i':
        sqlite3_bind_int64(statement, column, value->integer);
        break;
    case 'r':
        sqlite3_bind_double(statement, column, value->real); /* NaN becomes NULL */
        break;
    case 't':
        sqlite3_bind_text64(statement, column, value->bytes, value->n, SQLITE_STATIC, SQLITE_UTF8);
        break;
    default:
        /* A NULL pointer would bind SQL NULL. */
        sqlite3_bind_blob64(statement, column, value->n ? value->bytes : "", value->n,
                            SQLITE_STATIC);
        break;
    }
}

/* Appends a row of any table. */
enum wb_status wb_recording_append_row(struct wb_recording *recording, enum wb_recording_kind kind,
                                       const struct wb_recording_value *values)
{
    WB_TRY(begin(recording));
    sqlite3_stmt *const statement = recording->insert[kind];
    const char *const types = wb_recording_tables[kind].types;
    const int n = (int)strlen(types);
    const int64_t number = recording->n_rows + 1;
    const uint32_t crc32 = wb_recording_row_crc32(kind, number, values);
    const uint32_t chain = wb_recording_chain(recording->chain, crc32);
    sqlite3_bind_int64(statement, 1, number);
    for (int i = 0; i < n; i++)
        bind(statement, 2 + i, types[i], &values[i]);
    sqlite3_bind_int64(statement, n + 2, crc32);
    sqlite3_bind_int64(statement, n + 3, chain);
    errno = 0;
    const int code = sqlite3_step(statement);
    const int error = errno;
    sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
    errno = error;
    if (code != SQLITE_DONE || !remember_row(recording, crc32))
        return roll_back(recording, code != SQLITE_DONE ? code : SQLITE_NOMEM);
    recording->n_rows = number;
    recording->chain = chain;
    return WB_OK;
}

static struct wb_recording_value integer(int64_t value)
{
    return (struct wb_recording_value){.integer = value, .bytes = ""};
}

static struct wb_recording_value text(const char *value)
{
    return (struct wb_recording_value){.bytes = value, .n = strlen(value)};
}

enum wb_status wb_recording_set_meta(struct wb_recording *recording, const char *key,
                                     const char *value)
{
    const struct wb_recording_value values[] = {text(key), text(value)};
    return wb_recording_append_row(recording, WB_RECORDING_META, values);
}

enum wb_status wb_recording_add_stream(struct wb_recording *recording, enum wb_role role,
                                       const char *address, const char *protocol,
                                       const char *settings, int *id)
{
    struct wb_recording_stream stream = {.id = recording->n_streams, .role = role};
    snprintf(stream.address, sizeof stream.address, "%s", address);
    snprintf(stream.protocol, sizeof stream.protocol, "%s", protocol);
    const struct wb_recording_value values[] = {integer(stream.id), text(wb_role_name(role)),
                                                text(stream.address), text(stream.protocol),
                                                text(settings ? settings : "")};
    WB_TRY(wb_recording_append_row(recording, WB_RECORDING_STREAM, values));
    WB_TRY(wb_recording_remember_stream(recording, &stream, settings ? settings : ""));
    *id = stream.id;
    return WB_OK;
}

enum wb_status wb_recording_append_chunk(struct wb_recording *recording, int stream, int64_t seq,
                                         int64_t t_ns, const void *bytes, size_t n)
{
    if (stream < 0 || stream >= recording->n_streams)
        return wb_fail(WB_ERR_ARGUMENT, "'%s' has no stream %d", recording->path, stream);
    const struct wb_recording_value values[] = {
        integer(stream), integer(seq), integer(t_ns), {.bytes = n ? bytes : "", .n = n}};
    return wb_recording_append_row(recording, WB_RECORDING_CHUNK, values);
}

enum wb_status wb_recording_append_event(struct wb_recording *recording, int64_t t_ns,
                                         const char *kind, const char *what)
{
    const struct wb_recording_value values[] = {integer(t_ns), text(kind), text(what)};
    return wb_recording_append_row(recording, WB_RECORDING_EVENT, values);
}

enum wb_status wb_recording_append_clock(struct wb_recording *recording, int stream,
                                         int64_t t_host_ns, double t_device, int64_t rtt_ns)
{
    const struct wb_recording_value values[] = {
        integer(stream), integer(t_host_ns), {.real = t_device, .bytes = ""}, integer(rtt_ns)};
    return wb_recording_append_row(recording, WB_RECORDING_CLOCK, values);
}

static const int64_t checkpoint_interval_ns = WB_NS_PER_S;

/* Moves flushed rows from the log into the file once a second, because the log is lost when only
 * the file is copied. If that fails, the rows remain in the log. */
static void checkpoint_when_due(struct wb_recording *recording)
{
    const int64_t now = wb_time_now_ns();
    if (now - recording->checkpoint_ns < checkpoint_interval_ns)
        return;
    sqlite3_wal_checkpoint_v2(recording->db, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL, NULL);
    recording->checkpoint_ns = now;
}

enum wb_status wb_recording_flush(struct wb_recording *recording)
{
    if (!recording->in_transaction)
        return recording->failed;
    errno = 0;
    int code = sqlite3_exec(recording->db, "COMMIT", NULL, NULL, NULL);
    if (code != SQLITE_OK)
        return roll_back(recording, code);
    recording->in_transaction = false;
    recording->failed = WB_OK;
    for (size_t i = 0; i < recording->n_unflushed; i++)
        wb_recording_digest_add(recording->digest, recording->unflushed[i]);
    recording->n_unflushed = 0;
    recording->flushed_chain = recording->chain;
    checkpoint_when_due(recording);
    return WB_OK;
}

/* Writes the digest of all rows as the last row, which proves that the end is present, and makes a
 * single file, readable from a read-only folder. */
static enum wb_status finish_file(struct wb_recording *recording)
{
    char now[WB_TIME_TEXT], hex[WB_SHA256_TEXT];
    wb_time_format(wb_time_utc(), now);
    WB_TRY(wb_recording_set_meta(recording, "closed", now));
    WB_TRY(wb_recording_flush(recording));
    wb_hash_so_far(recording->digest, hex);
    WB_TRY(wb_recording_set_meta(recording, WB_RECORDING_DIGEST, hex));
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

/* Makes a single file if the disk permits. Otherwise the log is kept: SQLite would checkpoint and
 * delete it, although the header of the file would still require it. */
static void leave_unclosed(struct wb_recording *recording)
{
    sqlite3_db_config(recording->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    sqlite3_exec(recording->db, "PRAGMA journal_mode=DELETE", NULL, NULL, NULL);
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
        if (status != WB_OK)
            leave_unclosed(recording);
    }
    wb_recording_release(recording);
    return status;
}
