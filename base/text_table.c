#include "base/text_table.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <glib.h>

#include "base/config.h"
#include "base/memory.h"
#include "base/number.h"

#define WB_LOG_DOMAIN "table"

enum {
    MAX_COLUMNS = 256,
    MAX_LINES = 50000000,
    SAMPLE = 2000, /* number of lines examined to find the delimiter */
    NUMBER = 64    /* maximum bytes of a number */
};

/* --- encodings --- */

const char *wb_text_encoding_name(enum wb_text_encoding encoding)
{
    static const char *const names[] = {"UTF-8", "UTF-16 little endian", "UTF-16 big endian",
                                        "Latin-1"};
    return names[encoding];
}

/* Text decoded from a file. */
struct decoded_text {
    char *bytes; /* UTF-8 without byte order mark, NUL-terminated; owned, freed by the caller */
    size_t size; /* without the NUL */
    enum wb_text_encoding encoding;
    bool byte_order_mark;
    bool cut; /* incomplete character at the end, dropped */
};

/* A NUL is valid UTF-8; it is rejected later, as a character that is not text. */
static bool is_utf8(const char *bytes, size_t n)
{
    const char *const end = bytes + n;
    while (!g_utf8_validate_len(bytes, (gsize)(end - bytes), &bytes)) {
        if (*bytes != '\0')
            return false;
        bytes++;
    }
    return true;
}

/* UTF-16 text in Latin letters has a zero in every second byte. */
static bool has_zeros_in(const uint8_t *bytes, size_t n, size_t odd)
{
    size_t zeros[2] = {0, 0};
    const size_t looked_at = n < 8192 ? n : 8192;
    for (size_t i = 0; i < looked_at; i++)
        zeros[i & 1] += bytes[i] == 0;
    return zeros[odd] * 10 > looked_at * 3 && zeros[1 - odd] * 20 < looked_at;
}

static size_t find_encoding(const uint8_t *bytes, size_t n, struct decoded_text *text)
{
    text->byte_order_mark = true;
    if (n >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0) {
        text->encoding =
            is_utf8((const char *)bytes + 3, n - 3) ? WB_ENCODING_UTF8 : WB_ENCODING_LATIN1;
        return 3;
    }
    if (n >= 2 && memcmp(bytes, "\xff\xfe", 2) == 0) {
        text->encoding = WB_ENCODING_UTF16_LE;
        return 2;
    }
    if (n >= 2 && memcmp(bytes, "\xfe\xff", 2) == 0) {
        text->encoding = WB_ENCODING_UTF16_BE;
        return 2;
    }
    text->byte_order_mark = false;
    text->encoding = has_zeros_in(bytes, n, 1)         ? WB_ENCODING_UTF16_LE
                     : has_zeros_in(bytes, n, 0)       ? WB_ENCODING_UTF16_BE
                     : is_utf8((const char *)bytes, n) ? WB_ENCODING_UTF8
                                                       : WB_ENCODING_LATIN1;
    return 0;
}

/* Line and column of the end of a text, from 1, for messages. */
static void place_of(const char *text, size_t n, int *line, int *column)
{
    *line = *column = 1;
    for (size_t i = 0; i < n; i++) {
        if (text[i] == '\n' || (text[i] == '\r' && (i + 1 == n || text[i + 1] != '\n'))) {
            ++*line;
            *column = 1;
        } else if (((uint8_t)text[i] & 0xc0) != 0x80) {
            ++*column;
        }
    }
}

static enum wb_status reject_character(const struct decoded_text *text, const char *name,
                                       uint32_t c, const char *description, struct wb_reason *why)
{
    int line, column;
    place_of(text->bytes, text->size, &line, &column);
    return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: character %d (0x%02x) is %s: expected text in %s",
                      name, line, column, (unsigned)c, description,
                      wb_text_encoding_name(text->encoding));
}

static bool is_text(uint32_t c)
{
    return c >= 0x20 ? c != 0x7f : c == '\t' || c == '\n' || c == '\r';
}

static enum wb_status decode_utf16(const uint8_t *bytes, size_t n, const char *name,
                                   struct decoded_text *text, struct wb_reason *why)
{
    const size_t low = text->encoding == WB_ENCODING_UTF16_LE ? 0 : 1;
    for (size_t i = 0; i + 1 < n; i += 2) {
        uint32_t c = (uint32_t)bytes[i + low] | (uint32_t)bytes[i + 1 - low] << 8;
        if (c >= 0xd800 && c < 0xe000) {
            const uint32_t next =
                i + 3 < n ? (uint32_t)bytes[i + 2 + low] | (uint32_t)bytes[i + 3 - low] << 8 : 0;
            if (c >= 0xdc00 || next < 0xdc00 || next >= 0xe000)
                return reject_character(text, name, c, "half of a surrogate pair", why);
            c = 0x10000 + ((c & 0x3ff) << 10) + (next & 0x3ff);
            i += 2;
        }
        if (!is_text(c))
            return reject_character(text, name, c, "not a text character", why);
        text->size += (size_t)g_unichar_to_utf8(c, text->bytes + text->size);
    }
    text->cut = n % 2 != 0;
    return WB_OK;
}

static enum wb_status decode_bytes(const uint8_t *bytes, size_t n, const char *name,
                                   struct decoded_text *text, struct wb_reason *why)
{
    for (size_t i = 0; i < n; i++) {
        const bool latin1 = text->encoding == WB_ENCODING_LATIN1;
        if (!is_text(bytes[i]) && !(bytes[i] == 0x1a && i + 1 == n)) /* the end mark of DOS */
            return reject_character(text, name, bytes[i], "not a text character", why);
        if (bytes[i] == 0x1a)
            continue;
        if (latin1)
            text->size += (size_t)g_unichar_to_utf8(bytes[i], text->bytes + text->size);
        else
            text->bytes[text->size++] = (char)bytes[i];
    }
    return WB_OK;
}

static enum wb_status decode(const void *bytes, size_t size, const char *name,
                             struct decoded_text *text, struct wb_reason *why)
{
    struct decoded_text decoded = {NULL, 0, WB_ENCODING_UTF8, false, false};
    if (size >= 4 &&
        (memcmp(bytes, "\xff\xfe\0\0", 4) == 0 || memcmp(bytes, "\0\0\xfe\xff", 4) == 0))
        return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                          "%s: UTF-32 is not supported; save the file as UTF-8 or UTF-16", name);
    const size_t start = find_encoding(bytes, size, &decoded);
    decoded.bytes = wb_memory_new(2 * size + 1, 1);
    const uint8_t *const from = (const uint8_t *)bytes + start;
    const bool wide =
        decoded.encoding == WB_ENCODING_UTF16_LE || decoded.encoding == WB_ENCODING_UTF16_BE;
    const enum wb_status status = wide ? decode_utf16(from, size - start, name, &decoded, why)
                                       : decode_bytes(from, size - start, name, &decoded, why);
    if (status != WB_OK) {
        free(decoded.bytes);
        return status;
    }
    decoded.bytes[decoded.size] = '\0';
    *text = decoded;
    return WB_OK;
}

/* --- lines --- */

struct line {
    char *text; /* NUL-terminated */
    int number;
};

struct lines {
    struct line *items;
    size_t n, room;
};

static void add_line(struct lines *lines, char *text, int number)
{
    lines->items = wb_memory_room(lines->items, &lines->room, lines->n + 1, sizeof *lines->items);
    lines->items[lines->n++] = (struct line){text, number};
}

/* Splits the text into lines in place. Carriage returns before a line feed belong to the line
 * end. */
static enum wb_status cut_lines(struct wb_text_table *table, size_t size, const char *name,
                                struct lines *lines, struct wb_reason *why)
{
    char *at = table->text, *const end = at + size;
    int number = 0;
    while (at < end) {
        char *stop = at;
        while (stop < end && *stop != '\n' && *stop != '\r')
            stop++;
        char *next = stop;
        while (next < end && *next == '\r')
            next++;
        if (next < end && *next == '\n')
            next++;
        else if (next > stop)
            next = stop + 1;
        table->ends_without_end = stop == end;
        if (number == MAX_LINES)
            return wb_fail_to(why, WB_ERR_FORMAT, "%s: more than %d lines", name, MAX_LINES);
        add_line(lines, at, ++number);
        if (stop < end)
            *stop = '\0';
        at = next;
    }
    table->n_lines = number;
    return WB_OK;
}

/* --- fields --- */

struct field {
    const char *text;
    size_t n;
    bool quoted;
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

/* The bytes C2 A0: a no-break space. */
static bool is_hard_blank(const char *at)
{
    return (uint8_t)at[0] == 0xc2 && (uint8_t)at[1] == 0xa0;
}

static void trim(struct field *field, char delimiter)
{
    for (;;) {
        if (field->n > 0 && is_blank(*field->text) && *field->text != delimiter) {
            field->text++;
            field->n--;
        } else if (field->n > 1 && is_hard_blank(field->text)) {
            field->text += 2;
            field->n -= 2;
        } else {
            break;
        }
    }
    for (;;) {
        if (field->n > 0 && is_blank(field->text[field->n - 1]))
            field->n--;
        else if (field->n > 1 && is_hard_blank(field->text + field->n - 2))
            field->n -= 2;
        else
            break;
    }
}

/* Takes the next field off a line, which `*rest` points into; `*rest` becomes NULL after the last
 * field. Consecutive blanks are one delimiter; blanks at the ends of a line are none. */
static bool next_field(const char **rest, char delimiter, struct field *field)
{
    const char *at = *rest;
    if (!at)
        return false;
    if (delimiter == ' ') {
        while (is_blank(*at))
            at++;
        if (*at == '\0')
            return false;
    }
    const char *skipped = at;
    while (is_blank(*skipped) && *skipped != delimiter)
        skipped++;
    if (*skipped == '"') {
        const char *close = skipped + 1;
        while (*close && !(close[0] == '"' && close[1] != '"'))
            close += close[0] == '"' ? 2 : 1;
        const char *after = close + (*close == '"');
        while (is_blank(*after) && *after != delimiter)
            after++;
        if (*close == '"' && (*after == delimiter || *after == '\0' || delimiter == ' ')) {
            *field = (struct field){skipped + 1, (size_t)(close - skipped - 1), true};
            trim(field, '\0');
            *rest = *after == '\0' ? NULL : delimiter == ' ' ? after : after + 1;
            return true;
        }
    }
    const char *stop = at;
    while (*stop && *stop != delimiter && !(delimiter == ' ' && *stop == '\t'))
        stop++;
    *field = (struct field){at, (size_t)(stop - at), false};
    trim(field, delimiter);
    *rest = *stop ? stop + 1 : NULL;
    return true;
}

static bool is_missing_word(const char *text, size_t n)
{
    static const char *const words[] = {"nan",  "-nan", "n/a", "na", "#n/a",
                                        "null", "none", "-",   "--", "---"};
    for (size_t i = 0; i < WB_COUNT(words); i++) {
        if (strlen(words[i]) == n && strncasecmp(text, words[i], n) == 0)
            return true;
    }
    return false;
}

static enum wb_text_field classify(const char *text, size_t n, char decimal, double *value)
{
    char number[NUMBER];
    if (n == 0 || is_missing_word(text, n))
        return WB_FIELD_EMPTY;
    if (n >= sizeof number || memchr(text, decimal == ',' ? '.' : ',', n))
        return WB_FIELD_TEXT;
    memcpy(number, text, n);
    number[n] = '\0';
    char *const comma = decimal == ',' ? memchr(number, ',', n) : NULL;
    if (comma)
        *comma = '.';
    return wb_number_parse(number, value) ? WB_FIELD_NUMBER : WB_FIELD_TEXT;
}

/* Contents of a line split by a delimiter; numbers with either decimal sign count. Empty fields at
 * its end do not count. */
struct content {
    int fields, numbers, texts;
};

static struct content look(const char *line, char delimiter)
{
    struct content content = {0, 0, 0};
    struct field field;
    int n = 0;
    while (next_field(&line, delimiter, &field)) {
        double value;
        enum wb_text_field kind = classify(field.text, field.n, '.', &value);
        if (kind == WB_FIELD_TEXT && (delimiter != ',' || field.quoted))
            kind = classify(field.text, field.n, ',', &value);
        n++;
        if (field.n == 0)
            continue;
        content.fields = n;
        content.numbers += kind == WB_FIELD_NUMBER;
        content.texts += kind == WB_FIELD_TEXT;
    }
    return content;
}

/* --- delimiter, columns, body --- */

struct layout {
    char delimiter;
    int columns;     /* of most rows */
    bool some_texts; /* rows may contain text besides numbers */
};

static bool is_row(const struct content *content, bool some_texts)
{
    return some_texts ? content->numbers >= 2 : content->numbers >= 1 && content->texts == 0;
}

/* The largest number of lines that are rows with the same number of columns under this delimiter,
 * and that number of columns. */
static size_t score(const struct lines *lines, char delimiter, bool some_texts, int *columns)
{
    size_t count[MAX_COLUMNS + 1] = {0};
    const size_t stride = 1 + lines->n / SAMPLE;
    *columns = 0;
    for (size_t i = 0; i < lines->n; i += stride) {
        const struct content content = look(lines->items[i].text, delimiter);
        if (is_row(&content, some_texts) && content.fields <= MAX_COLUMNS)
            count[content.fields]++;
    }
    for (int k = 1; k <= MAX_COLUMNS; k++) {
        if (count[k] > count[*columns])
            *columns = k;
    }
    return count[*columns];
}

/* Prefers two or more columns to one, then more rows. */
static bool find_layout(const struct lines *lines, char given, bool some_texts,
                        struct layout *layout)
{
    static const char candidates[] = {'\t', ';', '|', ',', ' '};
    size_t best = 0;
    for (size_t i = 0; i < sizeof candidates; i++) {
        int columns;
        if (given && candidates[i] != given)
            continue;
        const size_t rows = score(lines, candidates[i], some_texts, &columns);
        const bool wider = best > 0 && layout->columns == 1 && columns > 1 && 2 * rows > best;
        if (rows > 0 && (wider || rows > best) && !(best > 0 && columns == 1)) {
            best = rows;
            *layout = (struct layout){candidates[i], columns, some_texts};
        }
    }
    return best > 0;
}

/* The first line of the rows: the next line that is not empty is also a row, or there is none. */
static size_t find_body(const struct lines *lines, const struct layout *layout)
{
    size_t candidate = lines->n;
    for (size_t i = 0; i < lines->n; i++) {
        const struct content content = look(lines->items[i].text, layout->delimiter);
        if (content.fields == 0)
            continue;
        if (!is_row(&content, layout->some_texts)) {
            candidate = lines->n;
            continue;
        }
        if (candidate < lines->n)
            return candidate;
        candidate = i;
    }
    return candidate;
}

/* --- the decimal sign --- */

/* 1,234 or 12,345,678: commas may be thousands separators. 0,123 is not one of these. */
static bool may_be_thousands(const struct field *field)
{
    const char *at = field->text;
    const char *const end = at + field->n;
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    const char *const comma = memchr(at, ',', (size_t)(end - at));
    if (!comma || comma == at || comma - at > 3 || *at == '0')
        return false;
    for (; at < comma; at++) {
        if (*at < '0' || *at > '9')
            return false;
    }
    while (at < end && *at == ',') {
        for (int i = 1; i <= 3; i++) {
            if (at + i >= end || at[i] < '0' || at[i] > '9')
                return false;
        }
        at += 4;
    }
    return at == end;
}

struct signs {
    bool point, comma, sure_comma;
    int comma_line, comma_column; /* position of the first field with a comma */
    char comma_text[NUMBER];
};

static void look_for_signs(const struct line *line, char delimiter, struct signs *signs)
{
    const char *rest = line->text;
    struct field field;
    for (int column = 1; next_field(&rest, delimiter, &field); column++) {
        double value;
        if (classify(field.text, field.n, '.', &value) == WB_FIELD_NUMBER) {
            signs->point = signs->point || memchr(field.text, '.', field.n);
        } else if (classify(field.text, field.n, ',', &value) == WB_FIELD_NUMBER ||
                   may_be_thousands(&field)) {
            if (!signs->comma) {
                signs->comma_line = line->number;
                signs->comma_column = column;
                snprintf(signs->comma_text, sizeof signs->comma_text, "%.*s", (int)field.n,
                         field.text);
            }
            signs->comma = true;
            signs->sure_comma = signs->sure_comma || !may_be_thousands(&field);
        }
    }
}

static enum wb_status find_decimal(struct wb_text_table *table, const struct lines *lines,
                                   size_t body, const char *name, struct wb_reason *why)
{
    struct signs signs = {false, false, false, 0, 0, ""};
    for (size_t i = body; i < lines->n; i++)
        look_for_signs(&lines->items[i], table->delimiter, &signs);
    if (signs.comma && signs.point)
        return wb_fail_to(
            why, WB_ERR_FORMAT,
            "%s:%d: column %d: '%s' has a comma but other numbers have a point: specify "
            "the decimal sign",
            name, signs.comma_line, signs.comma_column, signs.comma_text);
    if (signs.comma && !signs.sure_comma)
        return wb_fail_to(
            why, WB_ERR_FORMAT,
            "%s:%d: column %d: the comma in '%s' may be a decimal sign or a thousands "
            "separator: specify the decimal sign",
            name, signs.comma_line, signs.comma_column, signs.comma_text);
    table->decimal = signs.comma ? ',' : '.';
    return WB_OK;
}

/* --- the header --- */

/* True if all words are short, or in brackets, as units are, and none is a number. */
static bool is_line_of_units(const char *line, char delimiter)
{
    struct field field;
    bool any = false;
    while (next_field(&line, delimiter, &field)) {
        if (field.n == 0)
            continue;
        const bool bracketed = (*field.text == '(' && field.text[field.n - 1] == ')') ||
                               (*field.text == '[' && field.text[field.n - 1] == ']');
        if (!bracketed && (field.n > 6 || memchr(field.text, ' ', field.n)))
            return false;
        any = true;
    }
    return any;
}

/* Finds the header among the lines above the rows, and a line of units below it; each is `lines->n`
 * if there is none. */
static enum wb_status find_header(const struct lines *lines, size_t body,
                                  const struct layout *layout, const char *name, size_t *header,
                                  size_t *units, struct wb_reason *why)
{
    struct content content = {0, 0, 0};
    size_t above[2] = {lines->n, lines->n};
    *header = *units = lines->n;
    for (size_t i = body, found = 0; i-- > 0 && found < 2;) {
        content = look(lines->items[i].text, layout->delimiter);
        if (content.fields > 0)
            above[found++] = i;
    }
    if (above[0] == lines->n)
        return WB_OK;
    /* A row above a line of words would be lost silently: report it. */
    for (size_t i = 0; i < above[0]; i++) {
        content = look(lines->items[i].text, layout->delimiter);
        if (layout->columns > 1 && content.fields == layout->columns &&
            content.numbers == content.fields)
            return wb_fail_to(why, WB_ERR_FORMAT,
                              "%s:%d: text between rows of numbers: expected a row of numbers",
                              name, lines->items[above[0]].number);
    }
    content = look(lines->items[above[0]].text, layout->delimiter);
    const bool as_wide = content.fields >= layout->columns;
    if (content.numbers > 0 && (as_wide || content.texts > 1))
        return wb_fail_to(
            why, WB_ERR_FORMAT,
            "%s:%d: the line mixes numbers and words: expected column names or a row of numbers",
            name, lines->items[above[0]].number);
    if (content.numbers > 0)
        return WB_OK;
    if (!as_wide) {
        if (content.texts > 1)
            return wb_fail_to(
                why, WB_ERR_FORMAT,
                "%s:%d: %d column names above rows of %d fields: check the delimiter and "
                "whether the comma is the decimal sign",
                name, lines->items[above[0]].number, content.fields, layout->columns);
        return WB_OK;
    }
    *header = above[0];
    if (above[1] == lines->n || !is_line_of_units(lines->items[above[0]].text, layout->delimiter))
        return WB_OK;
    const struct content upper = look(lines->items[above[1]].text, layout->delimiter);
    if (upper.numbers == 0 && upper.texts >= content.texts && upper.fields >= layout->columns) {
        *header = above[1];
        *units = above[0];
    }
    return WB_OK;
}

/* --- the table --- */

/* Splits a line into at most `most` fields in place. Returns the number of fields up to the last
 * non-empty one, or `most` + 1 if there are more. */
static int cut_fields(char *line, char delimiter, int most, char **fields)
{
    const char *rest = line;
    struct field field;
    int n = 0, last = 0;
    while (next_field(&rest, delimiter, &field)) {
        char *const text = line + (field.text - line);
        if (field.n > 0)
            last = n + 1;
        if (n < most)
            fields[n] = text;
        n++;
        /* The byte after a field (delimiter, quote, blank or end) was already read. */
        text[field.n] = '\0';
    }
    return last > most ? most + 1 : last;
}

static void fill_names(struct wb_text_table *table, const struct lines *lines, size_t header,
                       size_t units)
{
    char *fields[MAX_COLUMNS];
    for (int k = 0; k < table->n_columns; k++)
        table->columns[k] = (struct wb_text_table_column){"", ""};
    if (header < lines->n) {
        table->header_line = lines->items[header].number;
        const int n = cut_fields(lines->items[header].text, table->delimiter, MAX_COLUMNS, fields);
        for (int k = 0; k < n && k < table->n_columns; k++)
            table->columns[k].name = fields[k];
    }
    if (units < lines->n) {
        const int n = cut_fields(lines->items[units].text, table->delimiter, MAX_COLUMNS, fields);
        for (int k = 0; k < n && k < table->n_columns; k++)
            table->columns[k].unit = fields[k];
    }
}

static enum wb_status fill_rows(struct wb_text_table *table, struct lines *lines, size_t first,
                                size_t body, const char *name, struct wb_reason *why)
{
    for (size_t i = first; i < lines->n; i++) {
        struct line *const line = &lines->items[i];
        char **const fields = table->fields + table->n_rows * (size_t)table->n_columns;
        if (i < body) {
            table->n_empty_lines += look(line->text, table->delimiter).fields == 0;
            continue;
        }
        for (int k = 0; k < table->n_columns; k++)
            fields[k] = NULL;
        const int n = cut_fields(line->text, table->delimiter, table->n_columns, fields);
        if (n > table->n_columns)
            return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: column %d: more fields than the %d %s",
                              name, line->number, n, table->n_columns,
                              table->header_line ? "columns of the header" : "of other rows");
        if (n == 0) {
            table->n_empty_lines++;
            continue;
        }
        table->lines[table->n_rows++] = line->number;
        if (i + 1 == lines->n && table->ends_without_end && n < table->n_columns)
            table->cut = true;
    }
    return WB_OK;
}

static enum wb_status fill(struct wb_text_table *table, struct lines *lines,
                           const struct wb_text_table_form *form, const char *name,
                           struct wb_reason *why)
{
    struct layout layout = {'\t', 1, false};
    size_t header, units;
    if (!find_layout(lines, form->delimiter, false, &layout) &&
        !find_layout(lines, form->delimiter, true, &layout))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: no row of numbers in the file", name,
                          table->n_lines > 0 ? table->n_lines : 1);
    const size_t body = find_body(lines, &layout);
    table->delimiter = layout.delimiter;
    table->decimal = form->decimal;
    if (body == lines->n)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: no consecutive rows of numbers", name);
    if (!form->decimal)
        WB_TRY(find_decimal(table, lines, body, name, why));
    WB_TRY(find_header(lines, body, &layout, name, &header, &units, why));
    table->n_columns = layout.columns;
    if (header < lines->n) {
        const int named = look(lines->items[header].text, table->delimiter).fields;
        table->n_columns = named > layout.columns ? named : layout.columns;
    }
    if (table->n_columns > MAX_COLUMNS)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: more than %d columns", name, MAX_COLUMNS);
    const size_t n = lines->n - body;
    table->columns = wb_memory_new((size_t)table->n_columns, sizeof *table->columns);
    table->fields = wb_memory_new(n * (size_t)table->n_columns, sizeof *table->fields);
    table->lines = wb_memory_new(n, sizeof *table->lines);
    fill_names(table, lines, header, units);
    const size_t first = units < lines->n ? units + 1 : header < lines->n ? header + 1 : body;
    return fill_rows(table, lines, first, body, name, why);
}

enum wb_status wb_text_table_parse(struct wb_text_table *table, const void *bytes, size_t size,
                                   const char *name, const struct wb_text_table_form *form,
                                   struct wb_reason *why)
{
    static const struct wb_text_table_form unknown = {'\0', '\0'};
    struct wb_text_table read = {0};
    struct decoded_text text;
    struct lines lines = {NULL, 0, 0};
    WB_TRY(decode(bytes, size, name, &text, why));
    read.text = text.bytes;
    read.encoding = text.encoding;
    read.byte_order_mark = text.byte_order_mark;
    read.cut = text.cut;
    enum wb_status status = cut_lines(&read, text.size, name, &lines, why);
    if (status == WB_OK)
        status = fill(&read, &lines, form ? form : &unknown, name, why);
    free(lines.items);
    if (status != WB_OK)
        wb_text_table_release(&read);
    else
        *table = read;
    return status;
}

void wb_text_table_release(struct wb_text_table *table)
{
    free(table->columns);
    free(table->fields);
    free(table->lines);
    free(table->text);
    memset(table, 0, sizeof *table);
}

enum wb_text_field wb_text_table_number(const struct wb_text_table *table, size_t row, int column,
                                        double *value)
{
    const char *const text = table->fields[row * (size_t)table->n_columns + (size_t)column];
    return text ? classify(text, strlen(text), table->decimal, value) : WB_FIELD_EMPTY;
}

enum wb_status wb_text_table_reject(const struct wb_text_table *table, const char *name, size_t row,
                                    int column, const char *message, struct wb_reason *why)
{
    const char *const text = table->fields[row * (size_t)table->n_columns + (size_t)column];
    const char *const header = table->columns[column].name;
    return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: column %d%s%.40s%s: %s, not '%.40s'", name,
                      table->lines[row], column + 1, *header ? " '" : "", header,
                      *header ? "'" : "", message, text ? text : "");
}
