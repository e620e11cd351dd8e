/* Checks the integrity of a recording: every row present and unchanged. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "daq/recording/recording_private.h"

#define WB_LOG_DOMAIN "recording"

struct checking {
    struct wb_recording_check *check;
    int64_t last;           /* the highest row number so far */
    int64_t chain;          /* after row `last`; -1: unknown */
    struct wb_hash *digest; /* of all rows so far */
};

void wb_recording_add_place(char *places, size_t size, const char *place)
{
    const size_t n = strlen(places);
    if (n + strlen(place) + 8 < size)
        snprintf(places + n, size - n, "%s%s", n ? ", " : "", place);
    else if (n + 6 < size && (n < 3 || strcmp(places + n - 3, "...") != 0))
        snprintf(places + n, size - n, ", ...");
}

/* Describes a row for the list of places. */
static void describe(const struct wb_recording_row *row, char *text, size_t size)
{
    const struct wb_recording_value *const v = row->values;
    switch (row->kind) {
    case WB_RECORDING_META:
        snprintf(text, size, "row %" PRId64 " (meta '%.*s')", row->number,
                 (int)(v[0].n < 24 ? v[0].n : 24), (const char *)v[0].bytes);
        break;
    case WB_RECORDING_CHUNK:
        snprintf(text, size, "row %" PRId64 " (stream %" PRId64 ", chunk %" PRId64 ")", row->number,
                 v[0].integer, v[1].integer);
        break;
    default:
        snprintf(text, size, "row %" PRId64 " (%s)", row->number,
                 wb_recording_tables[row->kind].name);
        break;
    }
}

static void note_lost(struct wb_recording_check *check, int64_t first, int64_t last)
{
    char place[64];
    if (first == last)
        snprintf(place, sizeof place, "row %" PRId64, first);
    else
        snprintf(place, sizeof place, "rows %" PRId64 " to %" PRId64, first, last);
    check->lost += (uint64_t)(last - first + 1);
    wb_recording_add_place(check->lost_where, sizeof check->lost_where, place);
}

static bool is_digest(const struct wb_recording_row *row)
{
    const struct wb_recording_value *const key = &row->values[0];
    return row->kind == WB_RECORDING_META && key->n == strlen(WB_RECORDING_DIGEST) &&
           memcmp(key->bytes, WB_RECORDING_DIGEST, key->n) == 0;
}

/* The digest covers all rows before its own. */
static void check_digest(struct checking *checking, const struct wb_recording_row *row)
{
    char hex[WB_SHA256_TEXT];
    const struct wb_recording_value *const value = &row->values[1];
    wb_hash_so_far(checking->digest, hex);
    checking->check->is_closed = true;
    checking->check->digest_fits =
        value->n == WB_SHA256_TEXT - 1 && memcmp(value->bytes, hex, value->n) == 0;
}

static enum wb_status check_row(void *context, const struct wb_recording_row *row)
{
    struct checking *const checking = context;
    struct wb_recording_check *const check = checking->check;
    char place[80];
    check->rows++;
    describe(row, place, sizeof place);
    if (!row->intact) {
        check->damaged++;
        wb_recording_add_place(check->damaged_where, sizeof check->damaged_where, place);
    }
    if (!check->is_protected)
        return WB_OK;
    /* The number of a damaged row is only believed if it is the expected one. */
    if (!row->intact && row->number != checking->last + 1) {
        checking->chain = -1;
        return WB_OK;
    }
    const bool follows = row->number == checking->last + 1;
    const bool fits =
        checking->chain < 0 || row->crc32 < 0 ||
        row->chain == (int64_t)wb_recording_chain((uint32_t)checking->chain, (uint32_t)row->crc32);
    if (row->number > checking->last + 1)
        note_lost(check, checking->last + 1, row->number - 1);
    if (row->number <= checking->last || (follows && row->intact && !fits)) {
        check->displaced++;
        wb_recording_add_place(check->displaced_where, sizeof check->displaced_where, place);
    }
    check->after_digest += check->is_closed;
    if (row->intact && is_digest(row))
        check_digest(checking, row);
    if (row->number > checking->last) {
        checking->last = row->number;
        checking->chain = row->chain;
    }
    wb_recording_digest_add(checking->digest, (uint32_t)row->crc32);
    return WB_OK;
}

enum wb_status wb_recording_check(struct wb_recording *recording, struct wb_recording_check *check)
{
    *check = (struct wb_recording_check){.is_protected = recording->schema >= 2};
    struct checking checking = {.check = check, .digest = wb_hash_create()};
    const enum wb_status status =
        wb_recording_scan(recording, check_row, &checking, &check->is_broken);
    wb_hash_destroy(checking.digest);
    return status;
}
