#include "daq/recording/recording_salvage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* https://www.sqlite.org/fileformat2.html: 1.6 (pages of trees), 2.1 (records), 4 (the log). */
enum {
    PAGE = 4096, /* page size of wb_recording_create() */
    LEAF_OF_TABLE = 0x0d,
    LOG_HEADER = 32,
    FRAME_HEADER = 24,
    MOST_INLINE = PAGE - 35,                   /* largest row without overflow pages, bytes */
    LEAST_INLINE = (PAGE - 12) * 32 / 255 - 23 /* least part in the leaf page of larger rows */
};

/* A row in a leaf page of the file or the log. */
struct cell {
    int64_t number;
    const uint8_t *at; /* the record */
    size_t n, n_inline;
};

/* Location of a row. */
struct place {
    struct cell cell;
    uint32_t crc32, chain;
    uint32_t followers; /* rows after it in the chain */
    enum wb_recording_kind kind;
    bool is_file_first; /* overflow pages are taken from the file rather than from the log */
};

/* A page in the log. */
struct frame {
    uint32_t page, index;
};

struct wb_recording_salvage {
    const uint8_t *file, *log;
    size_t n_pages;     /* complete pages in the file */
    uint8_t tail[PAGE]; /* the truncated last page, padded with zeros */
    struct frame *frames;
    size_t n_frames; /* by page, then by index */
    struct place *places;
    size_t n_places, capacity;
    uint8_t *payload; /* a row with overflow pages, assembled */
    uint64_t budget;  /* bytes of overflow pages that may still be read; ends cycles in damaged
                         chains of pages */
};

/* --- the log --- */

static uint32_t word(const uint8_t *p, bool is_big)
{
    return is_big ? wb_recording_big_endian(p)
                  : (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0];
}

/* Fletcher checksum of the log, over pairs of words. */
static void add_sum(uint32_t sum[2], const uint8_t *bytes, size_t n, bool is_big)
{
    for (size_t i = 0; i + 8 <= n; i += 8) {
        sum[0] += word(bytes + i, is_big) + sum[1];
        sum[1] += word(bytes + i + 4, is_big) + sum[0];
    }
}

void wb_recording_log_count(const uint8_t *bytes, size_t n, struct wb_recording_log *log)
{
    *log = (struct wb_recording_log){0};
    if (n < LOG_HEADER)
        return;
    const bool is_big = (wb_recording_big_endian(bytes) & 1) != 0;
    const uint8_t *const salt = bytes + 16;
    uint32_t sum[2] = {0, 0};
    add_sum(sum, bytes, 24, is_big);
    bool fits = (wb_recording_big_endian(bytes) | 1) == 0x377f0683 &&
                wb_recording_big_endian(bytes + 8) == PAGE &&
                wb_recording_big_endian(bytes + 24) == sum[0] &&
                wb_recording_big_endian(bytes + 28) == sum[1];
    for (size_t at = LOG_HEADER; at + FRAME_HEADER + PAGE <= n; at += FRAME_HEADER + PAGE) {
        const uint8_t *const frame = bytes + at;
        /* A frame of an older log, or a damaged one. */
        if (memcmp(frame + 8, salt, 8) != 0) {
            fits = false;
            continue;
        }
        add_sum(sum, frame, 8, is_big);
        add_sum(sum, frame + FRAME_HEADER, PAGE, is_big);
        fits = fits && wb_recording_big_endian(frame + 16) == sum[0] &&
               wb_recording_big_endian(frame + 20) == sum[1];
        log->frames++;
        log->readable += fits;
    }
}

static int compare_frames(const void *a, const void *b)
{
    const struct frame *const x = a, *const y = b;
    if (x->page != y->page)
        return x->page < y->page ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

static const uint8_t *frame_page(const struct wb_recording_salvage *s, uint32_t index)
{
    return s->log + LOG_HEADER + (size_t)index * (FRAME_HEADER + PAGE) + FRAME_HEADER;
}

static void list_frames(struct wb_recording_salvage *s, size_t n_log)
{
    const size_t n = n_log > LOG_HEADER ? (n_log - LOG_HEADER) / (FRAME_HEADER + PAGE) : 0;
    if (n == 0)
        return;
    s->frames = wb_memory_new(n, sizeof *s->frames);
    for (size_t i = 0; i < n && i < UINT32_MAX; i++)
        s->frames[s->n_frames++] = (struct frame){
            wb_recording_big_endian(frame_page(s, (uint32_t)i) - FRAME_HEADER), (uint32_t)i};
    qsort(s->frames, s->n_frames, sizeof *s->frames, compare_frames);
}

/* Finds a page by its number: the last version in the log or, failing that, in the file; with
 * `is_file_first` in the reverse order. NULL: not found. */
static const uint8_t *find_page(const struct wb_recording_salvage *s, uint32_t number,
                                bool is_file_first)
{
    const uint8_t *const in_file = number > 0 && number <= s->n_pages
                                       ? s->file + (size_t)(number - 1) * PAGE
                                   : number > 0 && number - 1 == s->n_pages ? s->tail
                                                                            : NULL;
    if (is_file_first && in_file)
        return in_file;
    size_t low = 0, high = s->n_frames; /* the first frame of a higher page */
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (s->frames[middle].page <= number)
            low = middle + 1;
        else
            high = middle;
    }
    if (low > 0 && s->frames[low - 1].page == number)
        return frame_page(s, s->frames[low - 1].index);
    return in_file;
}

/* --- rows --- */

/* Reads a number of one to nine bytes: seven bits each, eight in the ninth. False if truncated. */
static bool read_varint(const uint8_t **at, const uint8_t *end, uint64_t *value)
{
    *value = 0;
    for (int i = 0; i < 9; i++) {
        if (*at >= end)
            return false;
        const uint8_t byte = *(*at)++;
        if (i == 8) {
            *value = *value << 8 | byte;
            return true;
        }
        *value = *value << 7 | (byte & 0x7f);
        if (!(byte & 0x80))
            return true;
    }
    return false;
}

/* Bytes of a row of n bytes that are in its leaf page. */
static size_t inline_bytes(uint64_t n)
{
    if (n <= MOST_INLINE)
        return (size_t)n;
    const size_t k = LEAST_INLINE + (size_t)((n - LEAST_INLINE) % (PAGE - 4));
    return k <= MOST_INLINE ? k : LEAST_INLINE;
}

/* Assembles a row with overflow pages. */
static bool assemble(struct wb_recording_salvage *s, const uint8_t *at, size_t n_inline, size_t n,
                     bool is_file_first)
{
    if (n > s->budget)
        return false;
    s->budget -= n;
    s->payload = wb_memory_resize(s->payload, n, 1);
    memcpy(s->payload, at, n_inline);
    uint32_t next = wb_recording_big_endian(at + n_inline);
    for (size_t done = n_inline; done < n;) {
        const uint8_t *const page = find_page(s, next, is_file_first);
        if (!page)
            return false;
        const size_t part = n - done < PAGE - 4 ? n - done : PAGE - 4;
        memcpy(s->payload + done, page + 4, part);
        done += part;
        next = wb_recording_big_endian(page);
    }
    return true;
}

/* Reads the value of a column and advances; false if it has another type. */
static bool read_value(char type, uint64_t serial, const uint8_t **body, const uint8_t *end,
                       struct wb_recording_value *value)
{
    static const uint8_t widths[] = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
    *value = (struct wb_recording_value){.bytes = *body};
    if (serial >= 12) {
        value->n = (size_t)((serial - 12) / 2);
        if (value->n > (size_t)(end - *body) || type != (serial % 2 ? 't' : 'b'))
            return false;
        *body += value->n;
        return true;
    }
    if (serial > 9 || widths[serial] > end - *body)
        return false;
    uint64_t bits = serial > 0 && serial < 7 && (*body)[0] & 0x80 ? UINT64_MAX : 0;
    for (int i = 0; i < widths[serial]; i++)
        bits = bits << 8 | *(*body)++;
    if (serial == 9)
        bits = 1;
    if (type == 'i') {
        memcpy(&value->integer, &bits, sizeof bits);
        return (serial > 0 && serial < 7) || serial > 7;
    }
    if (type != 'r')
        return false;
    /* SQLite stores NaN as NULL, and a real without fraction as an integer. */
    int64_t whole;
    memcpy(&whole, &bits, sizeof bits);
    if (serial == 7)
        memcpy(&value->real, &bits, sizeof bits);
    else
        value->real = serial == 0 ? (double)NAN : (double)whole;
    return true;
}

/* Decodes a record as a row of one table: number (not part of the record), values, checksum, chain.
 * True if the checksum matches. */
static bool read_record(enum wb_recording_kind kind, const uint8_t *record, size_t n,
                        struct wb_recording_row *row)
{
    const char *const types = wb_recording_tables[kind].types;
    const int n_values = (int)strlen(types);
    const uint8_t *at = record;
    uint64_t n_header, serial;
    if (!read_varint(&at, record + n, &n_header) || n_header > n)
        return false;
    const uint8_t *const end = record + n, *const end_of_header = record + n_header;
    const uint8_t *body = end_of_header;
    if (!read_varint(&at, end_of_header, &serial) || serial != 0)
        return false;
    for (int i = 0; i < n_values + 2; i++) {
        struct wb_recording_value value;
        if (!read_varint(&at, end_of_header, &serial) ||
            !read_value(i < n_values ? types[i] : 'i', serial, &body, end, &value))
            return false;
        if (i < n_values)
            row->values[i] = value;
        else if (i == n_values)
            row->crc32 = value.integer;
        else
            row->chain = value.integer;
    }
    row->kind = kind;
    row->intact = true;
    row->is_nothing = false;
    return at == end_of_header && row->chain >= 0 && row->chain <= UINT32_MAX &&
           row->crc32 == wb_recording_row_crc32(kind, row->number, row->values);
}

/* Reads the header of a cell. */
static bool read_cell(const uint8_t *at, const uint8_t *end, struct cell *cell)
{
    uint64_t n, number;
    if (!read_varint(&at, end, &n) || !read_varint(&at, end, &number) || n == 0 ||
        n > WB_RECORDING_LONGEST_VALUE)
        return false;
    memcpy(&cell->number, &number, sizeof number);
    cell->at = at;
    cell->n = (size_t)n;
    cell->n_inline = inline_bytes(n);
    const size_t taken = cell->n_inline + (cell->n_inline < cell->n ? 4 : 0);
    return cell->number > 0 && taken <= (size_t)(end - at);
}

static bool read_row(struct wb_recording_salvage *s, const struct cell *cell, bool is_file_first,
                     int first, int last, struct wb_recording_row *row)
{
    const uint8_t *record = cell->at;
    if (cell->n_inline < cell->n) {
        if (!assemble(s, cell->at, cell->n_inline, cell->n, is_file_first))
            return false;
        record = s->payload;
    }
    row->number = cell->number;
    for (int kind = first; kind <= last; kind++) {
        if (read_record((enum wb_recording_kind)kind, record, cell->n, row))
            return true;
    }
    return false;
}

/* Finds the rows of a page, if it is a leaf page of a table. */
static void scan_page(struct wb_recording_salvage *s, const uint8_t *page)
{
    if (page[0] != LEAF_OF_TABLE)
        return;
    const size_t n = (size_t)page[3] << 8 | page[4];
    size_t room = PAGE;
    for (size_t i = 0; i < n && 8 + 2 * i + 2 <= PAGE; i++) {
        const size_t at = (size_t)page[8 + 2 * i] << 8 | page[9 + 2 * i];
        struct cell cell;
        struct wb_recording_row row;
        if (at < 8 || at >= PAGE || !read_cell(page + at, page + PAGE, &cell))
            continue;
        if (cell.n_inline > room)
            break;
        room -= cell.n_inline;
        const bool is_file_first = !read_row(s, &cell, false, 0, WB_RECORDING_TABLES - 1, &row);
        if (is_file_first && (cell.n_inline == cell.n ||
                              !read_row(s, &cell, true, 0, WB_RECORDING_TABLES - 1, &row)))
            continue;
        s->places = wb_memory_room(s->places, &s->capacity, s->n_places + 1, sizeof *s->places);
        s->places[s->n_places++] = (struct place){.cell = cell,
                                                  .crc32 = (uint32_t)row.crc32,
                                                  .chain = (uint32_t)row.chain,
                                                  .kind = row.kind,
                                                  .is_file_first = is_file_first};
    }
}

static int compare_places(const void *a, const void *b)
{
    const struct place *const x = a, *const y = b;
    if (x->cell.number != y->cell.number)
        return x->cell.number < y->cell.number ? -1 : 1;
    /* Every version of a page contains the same row. */
    return x->crc32 != y->crc32 ? (x->crc32 < y->crc32 ? -1 : 1) : 0;
}

static bool follows(const struct place *row, const struct place *before)
{
    return row->cell.number == before->cell.number + 1 &&
           row->chain == wb_recording_chain(before->chain, row->crc32);
}

/* Index after the last place with the same row number as place `i`. */
static size_t end_of_number(const struct wb_recording_salvage *s, size_t i)
{
    const int64_t number = s->places[i].cell.number;
    while (i < s->n_places && s->places[i].cell.number == number)
        i++;
    return i;
}

/* Counts for each place the rows that follow it in the chain. */
static void count_followers(struct wb_recording_salvage *s)
{
    for (size_t i = s->n_places; i-- > 0;) {
        struct place *const p = &s->places[i];
        const size_t next = end_of_number(s, i);
        const size_t end = next < s->n_places ? end_of_number(s, next) : next;
        for (size_t j = next; j < end; j++) {
            if (follows(&s->places[j], p) && s->places[j].followers >= p->followers)
                p->followers = s->places[j].followers + 1;
        }
    }
}

/* Removes identical rows from different versions of a page. */
static void drop_copies(struct wb_recording_salvage *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n_places; i++) {
        if (n == 0 || compare_places(&s->places[n - 1], &s->places[i]) != 0)
            s->places[n++] = s->places[i];
    }
    s->n_places = n;
}

/* Keeps one row per number. A failed transaction may have left rows whose numbers were used again:
 * the row that continues the chain and is followed by most rows is kept. */
static void keep_each_once(struct wb_recording_salvage *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n_places;) {
        const size_t end = end_of_number(s, i);
        size_t chosen = i;
        bool chosen_follows = n > 0 && follows(&s->places[i], &s->places[n - 1]);
        for (size_t j = i + 1; j < end; j++) {
            const bool fits = n > 0 && follows(&s->places[j], &s->places[n - 1]);
            if (fits != chosen_follows ? fits
                                       : s->places[j].followers > s->places[chosen].followers) {
                chosen = j;
                chosen_follows = fits;
            }
        }
        s->places[n++] = s->places[chosen];
        i = end;
    }
    s->n_places = n;
}

struct wb_recording_salvage *wb_recording_salvage_find(const uint8_t *file, size_t n_file,
                                                       const uint8_t *log, size_t n_log)
{
    struct wb_recording_salvage *const s = wb_memory_new(1, sizeof *s);
    s->file = file;
    s->log = log;
    s->n_pages = n_file / PAGE;
    memcpy(s->tail, file + s->n_pages * PAGE, n_file % PAGE);
    s->budget = 4 * ((uint64_t)n_file + n_log);
    list_frames(s, n_log);
    for (size_t i = 0; i < s->n_frames; i++)
        scan_page(s, frame_page(s, s->frames[i].index));
    for (size_t i = 0; i < s->n_pages; i++)
        scan_page(s, file + i * PAGE);
    scan_page(s, s->tail);
    if (s->n_places > 0)
        qsort(s->places, s->n_places, sizeof *s->places, compare_places);
    drop_copies(s);
    count_followers(s);
    keep_each_once(s);
    return s;
}

void wb_recording_salvage_destroy(struct wb_recording_salvage *salvage)
{
    if (!salvage)
        return;
    free(salvage->frames);
    free(salvage->places);
    free(salvage->payload);
    free(salvage);
}

size_t wb_recording_salvage_count(const struct wb_recording_salvage *salvage)
{
    return salvage->n_places;
}

void wb_recording_salvage_row(struct wb_recording_salvage *salvage, size_t index,
                              struct wb_recording_row *row)
{
    const struct place *const place = &salvage->places[index];
    salvage->budget = UINT64_MAX; /* the row was already read once: its chain of pages ends */
    if (!read_row(salvage, &place->cell, place->is_file_first, (int)place->kind, (int)place->kind,
                  row))
        *row = (struct wb_recording_row){.number = place->cell.number, .is_nothing = true};
}
