#include "daq/protocol/cells.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "base/number.h"

/* --- lines --- */

/* Encoding: 1 for UTF-16 little-endian, 2 for big-endian, 0 for bytes. Without a byte order mark,
 * ASCII text in UTF-16 is recognised by a zero in every other byte. */
static int utf16_order(const uint8_t *bytes, size_t n, size_t *skip)
{
    *skip = 2;
    if (n >= 2 && bytes[0] == 0xff && bytes[1] == 0xfe)
        return 1;
    if (n >= 2 && bytes[0] == 0xfe && bytes[1] == 0xff)
        return 2;
    *skip = 0;
    size_t zeros[2] = {0};
    const size_t looked_at = n < 64 ? n / 2 * 2 : 64;
    for (size_t i = 0; i < looked_at; i++)
        zeros[i % 2] += bytes[i] == 0;
    if (looked_at < 4)
        return 0;
    if (zeros[1] == looked_at / 2 && zeros[0] == 0)
        return 1;
    return zeros[0] == looked_at / 2 && zeros[1] == 0 ? 2 : 0;
}

void wb_cells_lines_begin(struct wb_cells_lines *lines, const uint8_t *bytes, size_t n)
{
    size_t skip;
    const int order = utf16_order(bytes, n, &skip);
    *lines = (struct wb_cells_lines){.at = (const char *)bytes, .end = (const char *)bytes + n};
    if (order == 0) {
        if (n >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0)
            lines->at += 3;
        return;
    }
    const size_t n_units = (n - skip) / 2;
    char *const text = wb_memory_new(n_units, 1);
    for (size_t i = 0; i < n_units; i++) {
        const uint8_t *const unit = bytes + skip + 2 * i;
        const uint8_t low = unit[order == 1 ? 0 : 1], high = unit[order == 1 ? 1 : 0];
        text[i] = high == 0 && low < 0x80 ? (char)low : '?';
    }
    lines->converted = text;
    lines->at = text;
    lines->end = text + n_units;
}

bool wb_cells_lines_next(struct wb_cells_lines *lines, struct wb_span *line)
{
    if (lines->at == lines->end)
        return false;
    const char *const from = lines->at;
    if (!lines->lf || lines->lf < from) {
        lines->lf = memchr(from, '\n', (size_t)(lines->end - from));
        if (!lines->lf)
            lines->lf = lines->end;
    }
    const char *const cr = memchr(from, '\r', (size_t)(lines->lf - from));
    const char *const end = cr ? cr : lines->lf;
    lines->terminated = end < lines->end;
    lines->at = end + lines->terminated;
    /* Only further CRs may be between a CR and its LF; otherwise the CR itself ends the line. */
    const char *next = end;
    while (cr && next < lines->lf && *next == '\r')
        next++;
    if (cr && next < lines->end && next == lines->lf)
        lines->at = next + 1;
    *line = (struct wb_span){from, (size_t)(end - from)};
    lines->number++;
    return true;
}

void wb_cells_lines_release(struct wb_cells_lines *lines)
{
    free(lines->converted);
    lines->converted = NULL;
}

/* --- cells --- */

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\0';
}

static struct wb_span trim(struct wb_span cell)
{
    while (cell.n > 0 && is_blank(cell.text[cell.n - 1]))
        cell.n--;
    for (; cell.n > 0 && is_blank(*cell.text); cell.n--)
        cell.text++;
    return cell;
}

void wb_cells_begin(struct wb_cells *cells, struct wb_span line, char delimiter)
{
    if (delimiter == ' ')
        line = trim(line);
    *cells = (struct wb_cells){line.text, line.text + line.n, delimiter, 0};
    if (delimiter == ' ' && line.n == 0)
        cells->at = NULL;
}

static const char *find_end(const struct wb_cells *cells)
{
    const char *at = cells->at;
    if (cells->delimiter == ' ') {
        while (at < cells->end && !is_blank(*at))
            at++;
        return at;
    }
    /* A quoted cell may contain delimiters. */
    while (at < cells->end && (*at == ' ' || *at == '\0'))
        at++;
    if (at < cells->end && *at == '"') {
        const char *const closing = memchr(at + 1, '"', (size_t)(cells->end - at - 1));
        at = closing ? closing : at;
    }
    while (at < cells->end && *at != cells->delimiter)
        at++;
    return at;
}

bool wb_cells_next(struct wb_cells *cells, struct wb_span *cell)
{
    if (!cells->at)
        return false;
    const char *end = find_end(cells);
    *cell = trim((struct wb_span){cells->at, (size_t)(end - cells->at)});
    if (cell->n >= 2 && *cell->text == '"' && cell->text[cell->n - 1] == '"')
        *cell = trim((struct wb_span){cell->text + 1, cell->n - 2});
    cells->column++;
    if (end == cells->end) {
        cells->at = NULL;
    } else {
        end++;
        while (cells->delimiter == ' ' && end < cells->end && is_blank(*end))
            end++;
        cells->at = end;
    }
    return true;
}

bool wb_cells_blank(struct wb_span line, char delimiter)
{
    for (size_t i = 0; i < line.n; i++)
        if (!is_blank(line.text[i]) && line.text[i] != delimiter && line.text[i] != '"')
            return false;
    return true;
}

bool wb_cells_equal(struct wb_span cell, const char *word)
{
    return cell.n == strlen(word) && wb_cells_begins(cell, word);
}

bool wb_cells_begins(struct wb_span cell, const char *word)
{
    return cell.n >= strlen(word) && strncasecmp(cell.text, word, strlen(word)) == 0;
}

struct wb_span wb_cells_strip(struct wb_span text)
{
    while (text.n > 0 && (isspace((unsigned char)text.text[text.n - 1]) || !text.text[text.n - 1]))
        text.n--;
    for (; text.n > 0 && isspace((unsigned char)*text.text); text.n--)
        text.text++;
    return text;
}

bool wb_cells_lists(const char *words, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = words; *at; at += strspn(at, " ")) {
        const size_t length = strcspn(at, " ");
        if (length == n && memcmp(at, word, n) == 0)
            return true;
        at += length;
    }
    return false;
}

/* --- numbers --- */

static bool slow_number(struct wb_span cell, char comma, double *value)
{
    char text[64];
    if (cell.n >= sizeof text)
        return false;
    for (size_t i = 0; i < cell.n; i++)
        text[i] = comma && cell.text[i] == comma ? '.' : cell.text[i];
    text[cell.n] = '\0';
    return strlen(text) == cell.n && wb_number_parse(text, value);
}

bool wb_cells_number(struct wb_span cell, char comma, double *value)
{
    static const double powers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    const char *at = cell.text, *const end = at + cell.n;
    const bool negative = at < end && *at == '-';
    at += at < end && (*at == '-' || *at == '+');
    uint64_t digits = 0;
    int n_digits = 0, n_decimals = 0;
    bool point = false;
    for (; at < end; at++) {
        const unsigned digit = (unsigned)*at - '0';
        if (digit <= 9) {
            digits = 10 * digits + digit;
            n_digits++;
            n_decimals += point;
        } else if (!point && (*at == '.' || (comma && *at == comma))) {
            point = true;
        } else {
            return slow_number(cell, comma, value);
        }
    }
    if (n_digits == 0)
        return false;
    /* Up to 15 digits both are exact, and their quotient is the nearest double. */
    if (n_digits > 15)
        return slow_number(cell, comma, value);
    const double magnitude = (double)digits / powers[n_decimals];
    *value = negative ? -magnitude : magnitude;
    return true;
}
