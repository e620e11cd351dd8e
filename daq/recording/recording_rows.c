/* Rows of recordings: columns of the tables, checksum of a row, chain of rows. */
#include <math.h>
#include <string.h>
#include <zlib.h>

#include "daq/recording/recording_private.h"

const struct wb_recording_table wb_recording_tables[WB_RECORDING_TABLES] = {
    [WB_RECORDING_META] = {"meta", "key, value", "tt"},
    [WB_RECORDING_STREAM] = {"stream", "id, role, address, protocol, settings", "itttt"},
    [WB_RECORDING_CHUNK] = {"chunk", "stream, seq, t_ns, bytes", "iiib"},
    [WB_RECORDING_EVENT] = {"event", "t_ns, kind, text", "itt"},
    [WB_RECORDING_CLOCK] = {"clock", "stream, t_host_ns, t_device, rtt_ns", "iiri"},
};

uint32_t wb_recording_crc32(const void *bytes, size_t n)
{
    return (uint32_t)crc32_z(crc32_z(0, NULL, 0), bytes, n);
}

/* Numbers enter a checksum as 8 bytes, least significant first. */
static uint8_t *put_number(uint8_t *to, uint64_t value)
{
    for (int i = 0; i < 8; i++)
        *to++ = (uint8_t)(value >> 8 * i);
    return to;
}

/* Bits of a number as SQLite stores it: without NaN and without the sign of zero. */
static uint64_t bits_of(double value)
{
    uint64_t bits;
    if (isnan(value))
        return UINT64_C(0x7ff8000000000000);
    value += 0.0;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* CRC-32 of the table's name with its NUL, the row's number and its values; texts and blobs enter
 * as length and bytes. */
uint32_t wb_recording_row_crc32(enum wb_recording_kind kind, int64_t number,
                                const struct wb_recording_value *values)
{
    const struct wb_recording_table *const table = &wb_recording_tables[kind];
    uint8_t numbers[8 * (WB_RECORDING_VALUES + 2)], *to = numbers;
    const size_t n_name = strlen(table->name) + 1;
    memcpy(numbers, table->name, n_name);
    to = put_number(numbers + n_name, (uint64_t)number);
    uint32_t crc = (uint32_t)crc32_z(0, NULL, 0);
    for (int i = 0; table->types[i]; i++) {
        const char type = table->types[i];
        if (type == 'i') {
            to = put_number(to, (uint64_t)values[i].integer);
        } else if (type == 'r') {
            to = put_number(to, bits_of(values[i].real));
        } else {
            to = put_number(to, values[i].n);
            crc = (uint32_t)crc32_z(crc, numbers, (size_t)(to - numbers));
            crc = (uint32_t)crc32_z(crc, values[i].bytes, values[i].n);
            to = numbers;
        }
    }
    return (uint32_t)crc32_z(crc, numbers, (size_t)(to - numbers));
}

uint32_t wb_recording_chain(uint32_t before, uint32_t row_crc32)
{
    uint8_t both[8];
    put_number(both, (uint64_t)row_crc32 << 32 | before);
    return wb_recording_crc32(both, sizeof both);
}

void wb_recording_digest_add(struct wb_hash *digest, uint32_t row_crc32)
{
    uint8_t bytes[8];
    put_number(bytes, row_crc32);
    wb_hash_add(digest, bytes, 4);
}

/* Reads a value; false if the column does not have the type with which it was written. */
static bool read_value(sqlite3_stmt *statement, int column, char type,
                       struct wb_recording_value *value)
{
    const int stored = sqlite3_column_type(statement, column);
    *value = (struct wb_recording_value){.bytes = ""};
    switch (type) {
    case 'i':
        value->integer = sqlite3_column_int64(statement, column);
        return stored == SQLITE_INTEGER;
    case 'r':
        value->real =
            stored == SQLITE_NULL ? (double)NAN : sqlite3_column_double(statement, column);
        return stored == SQLITE_FLOAT || stored == SQLITE_INTEGER || stored == SQLITE_NULL;
    default: {
        const void *const bytes = type == 't' ? (const void *)sqlite3_column_text(statement, column)
                                              : sqlite3_column_blob(statement, column);
        if (bytes)
            value->bytes = bytes;
        value->n = (size_t)sqlite3_column_bytes(statement, column);
        return stored == (type == 't' ? SQLITE_TEXT : SQLITE_BLOB);
    }
    }
}

/* Reads a stored checksum; -1 if the column has another type or range. */
static int64_t read_crc32(sqlite3_stmt *statement, int column)
{
    const int64_t value = sqlite3_column_int64(statement, column);
    return sqlite3_column_type(statement, column) == SQLITE_INTEGER && value >= 0 &&
                   value <= UINT32_MAX
               ? value
               : -1;
}

void wb_recording_read_row(const struct wb_recording_cursor *cursor, struct wb_recording_row *row)
{
    const enum wb_recording_kind kind = cursor->kind;
    sqlite3_stmt *const statement = cursor->statement;
    const char *const types = wb_recording_tables[kind].types;
    const int n = (int)strlen(types);
    *row = (struct wb_recording_row){
        .kind = kind, .number = sqlite3_column_int64(statement, 0), .intact = true};
    int n_strange = 0;
    for (int i = 0; i < n; i++)
        n_strange += !read_value(statement, 1 + i, types[i], &row->values[i]);
    row->is_nothing = n_strange == n;
    row->intact = n_strange == 0;
    row->crc32 = row->chain = -1;
    if (cursor->recording->schema >= 2) {
        row->crc32 = read_crc32(statement, 1 + n);
        row->chain = read_crc32(statement, 2 + n);
        row->intact &= row->crc32 == wb_recording_row_crc32(kind, row->number, row->values);
    } else if (kind == WB_RECORDING_CHUNK) {
        const struct wb_recording_value *const bytes = &row->values[WB_RECORDING_CHUNK_BYTES];
        row->crc32 = read_crc32(statement, 1 + n);
        row->intact &= row->crc32 == wb_recording_crc32(bytes->bytes, bytes->n);
    }
}
