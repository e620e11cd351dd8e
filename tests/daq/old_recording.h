/* Recordings as they were before everything in them was under a checksum (schema 1). */
#ifndef WB_TESTS_DAQ_OLD_RECORDING_H
#define WB_TESTS_DAQ_OLD_RECORDING_H

#include <sqlite3.h>
#include <zlib.h>

#include "tests/check.h"

static inline void old_recording_crc(sqlite3_context *context, int n, sqlite3_value **values)
{
    (void)n;
    const int size = sqlite3_value_bytes(values[0]);
    sqlite3_result_int64(context,
                         (sqlite3_int64)crc32_z(0, sqlite3_value_blob(values[0]), (size_t)size));
}

static inline void old_recording_run(const char *path, const char *sql)
{
    sqlite3 *db = NULL;
    char *message = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_create_function(db, "crc32_of", 1, SQLITE_UTF8, NULL,
                                             old_recording_crc, NULL, NULL),
                     SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s", message);
    sqlite3_close(db);
}

/* Converts a closed recording to schema 1. */
static inline void old_recording_make(const char *path)
{
    old_recording_run(
        path,
        "BEGIN;"
        "ALTER TABLE meta RENAME TO new_meta; ALTER TABLE stream RENAME TO new_stream;"
        "ALTER TABLE chunk RENAME TO new_chunk; ALTER TABLE event RENAME TO new_event;"
        "ALTER TABLE clock RENAME TO new_clock;"
        "CREATE TABLE meta(key TEXT PRIMARY KEY NOT NULL, value TEXT NOT NULL);"
        "CREATE TABLE stream(id INTEGER PRIMARY KEY NOT NULL, role TEXT NOT NULL,"
        " address TEXT NOT NULL, protocol TEXT NOT NULL, settings TEXT NOT NULL);"
        "CREATE TABLE chunk(stream INTEGER NOT NULL REFERENCES stream(id), seq INTEGER NOT NULL,"
        " t_ns INTEGER NOT NULL, bytes BLOB NOT NULL, crc32 INTEGER NOT NULL);"
        "CREATE TABLE event(t_ns INTEGER NOT NULL, kind TEXT NOT NULL, text TEXT NOT NULL);"
        "CREATE TABLE clock(stream INTEGER NOT NULL REFERENCES stream(id),"
        " t_host_ns INTEGER NOT NULL, t_device REAL, rtt_ns INTEGER NOT NULL);"
        "INSERT OR REPLACE INTO meta SELECT key, value FROM new_meta WHERE key <> 'digest' ORDER "
        "BY "
        "n;"
        "INSERT INTO stream SELECT id, role, address, protocol, settings FROM new_stream;"
        "INSERT INTO chunk SELECT stream, seq, t_ns, bytes, crc32_of(bytes) FROM new_chunk"
        " ORDER BY n;"
        "INSERT INTO event SELECT t_ns, kind, text FROM new_event ORDER BY n;"
        "INSERT INTO clock SELECT stream, t_host_ns, t_device, rtt_ns FROM new_clock ORDER BY n;"
        "DROP TABLE new_meta; DROP TABLE new_stream; DROP TABLE new_chunk; DROP TABLE new_event;"
        "DROP TABLE new_clock; PRAGMA user_version=1; COMMIT; VACUUM;");
}

#endif
