#include "daq/protocol/loadcell_line.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/config.h"
#include "base/number.h"
#include "base/units.h"
#include "daq/protocol/cells.h"

#define MAX_LINE 160

/* --- units --- */

/* Units with their spellings. Case-sensitive: a capital M or a lower-case n would be another prefix
 * or unit. */
static const struct {
    const char *names;
    double factor; /* kg or N */
    bool mass;
} units[] = {
    {"g G", WB_G, true},
    {"kg KG Kg", 1.0, true},
    {"mg", WB_MG, true},
    {"t", 1e3, true},
    {"lb LB lbs", WB_POUND, true},
    {"oz OZ", WB_OUNCE, true},
    {"ct CT", 2e-4, true},
    {"N", 1.0, false},
    {"mN", WB_MN, false},
    {"kN KN", 1e3, false},
    {"uN", 1e-6, false},
    {"lbF lbf LBF", WB_POUND_FORCE, false},
    {"ozF ozf", WB_POUND_FORCE / 16.0, false},
    {"gf gF", WB_G *WB_STANDARD_GRAVITY, false},
    {"kgf kgF", WB_STANDARD_GRAVITY, false},
};

bool wb_line_unit_factor(const char *unit, double gravity, double *newtons)
{
    for (size_t i = 0; i < WB_COUNT(units); i++) {
        if (!wb_cells_lists(units[i].names, unit))
            continue;
        *newtons = units[i].mass ? units[i].factor * gravity : units[i].factor;
        return true;
    }
    return false;
}

bool wb_line_force(const struct wb_line_reading *reading, const struct wb_rig_load_cell *cell,
                   double gravity, double *force)
{
    double newtons;
    if (!wb_line_unit_factor(reading->unit, gravity, &newtons) &&
        !wb_line_unit_factor(cell->unit, gravity, &newtons))
        return false;
    *force = cell->sign * (cell->scale * reading->value + cell->offset) * newtons;
    return true;
}

bool wb_line_unit_contradicts(const struct wb_line_reading *reading,
                              const struct wb_rig_load_cell *cell)
{
    double of_line, of_rig;
    /* The comparison does not depend on the value of gravity. */
    return wb_line_unit_factor(reading->unit, WB_STANDARD_GRAVITY, &of_line) &&
           wb_line_unit_factor(cell->unit, WB_STANDARD_GRAVITY, &of_rig) &&
           !(fabs(of_line - of_rig) <= 1e-9 * of_rig);
}

/* --- overload --- */

static bool is_separator(char c)
{
    return isspace((unsigned char)c) || c == ',' || c == ';' || c == ':' || c == '=';
}

/* Values of a saturated converter or a full display: infinity, the limits of 24 bits, only nines.
 */
static bool is_rail(const char *word)
{
    const char *digits = word + (*word == '+' || *word == '-');
    if (strcasecmp(digits, "inf") == 0 || strcasecmp(digits, "infinity") == 0)
        return true;
    if (strcmp(digits, "8388607") == 0 || strcmp(word, "-8388608") == 0)
        return true;
    digits += strspn(digits, "0");
    const size_t nines = strspn(digits, "9");
    return nines >= 7 && (digits[nines] == '\0' || tolower((unsigned char)digits[nines]) == 'e');
}

/* Whether a word equals one of the rig file's tokens, as text or as a number. */
static bool is_token(const char *word, const char tokens[WB_RIG_TOKENS][16])
{
    double value, token_value;
    if (!tokens[0][0])
        return false;
    const bool number = wb_number_parse(word, &value);
    for (int i = 0; i < WB_RIG_TOKENS && tokens[i][0]; i++) {
        if (strcasecmp(word, tokens[i]) == 0)
            return true;
        if (number && wb_number_parse(tokens[i], &token_value) && value == token_value)
            return true;
    }
    return false;
}

/* Searches the words of the line for overload and for marks of instability. Saturated values are
 * searched for only in the value's column, because a time stamp may be 9999999. */
static void look_for_tokens(const char *text, const struct wb_rig_load_cell *cell,
                            struct wb_line_reading *reading)
{
    char word[MAX_LINE];
    for (int column = 1; *text;) {
        size_t n = 0;
        while (text[n] && !is_separator(text[n]) && text[n] != cell->delimiter)
            n++;
        memcpy(word, text, n);
        word[n] = '\0';
        const bool selected = !cell->delimiter || column == cell->column;
        if (n > 0 && (strcasecmp(word, "OL") == 0 || (selected && is_rail(word)) ||
                      is_token(word, cell->overload_tokens)))
            reading->kind = WB_LINE_OVERLOAD;
        if (n > 0 && is_token(word, cell->unstable_tokens))
            reading->unstable = true;
        if (text[n] == '\0')
            return;
        column += text[n] == cell->delimiter;
        text += n + 1;
    }
}

/* --- the tokenizer --- */

struct cursor {
    const char *at;
    const struct wb_rig_load_cell *cell;
    struct wb_line_reading *reading;
};

static void skip_blanks(struct cursor *cursor)
{
    while (isspace((unsigned char)*cursor->at))
        cursor->at++;
}

static void reject(struct cursor *cursor, const char *reason)
{
    cursor->reading->kind = WB_LINE_REFUSED;
    cursor->reading->reason = reason;
}

/* Reads one of these signs if it stands alone: stable, dynamic, over or under range. False: none.
 */
static bool take_sign(struct cursor *cursor, const char *signs)
{
    const char sign = *cursor->at;
    if (sign == '\0' || !strchr(signs, sign) || !isspace((unsigned char)cursor->at[1]))
        return false;
    if (sign == 'D' || sign == '?')
        cursor->reading->unstable = true;
    if (sign == '^' || sign == 'v')
        cursor->reading->kind = WB_LINE_OVERLOAD;
    cursor->at++;
    skip_blanks(cursor);
    return true;
}

/* Reads a status word before the number: `ST`, `US`, `GS`, ..., followed by a delimiter. False:
 * none.
 */
static bool take_status(struct cursor *cursor)
{
    char word[4];
    const size_t n = strspn(cursor->at, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
    const char after = cursor->at[n];
    if (n >= sizeof word || !(isspace((unsigned char)after) || after == ','))
        return false;
    memcpy(word, cursor->at, n);
    word[n] = '\0';
    /* Replies to S, SI, SU and SUI: MT-SICS, Radwag. */
    const bool answers = wb_cells_lists("S SI SU SUI", word);
    if (!answers && !wb_cells_lists("SD ST US GS NT G N", word))
        return false;
    if (wb_cells_lists("US SD", word))
        cursor->reading->unstable = true;
    cursor->at += n;
    while (isspace((unsigned char)*cursor->at) || *cursor->at == ',')
        cursor->at++;
    if (answers)
        take_sign(cursor, "SD?^v");
    return true;
}

/* Reads a label before the number: letters, blanks and underscores up to a comma, colon or equals
 * sign. */
static bool take_label(struct cursor *cursor)
{
    size_t n = 0;
    while (isalpha((unsigned char)cursor->at[n]) ||
           (n > 0 && (cursor->at[n] == ' ' || cursor->at[n] == '_')))
        n++;
    if (n == 0 || !cursor->at[n] || !strchr(",:=", cursor->at[n]))
        return false;
    cursor->at += n + 1;
    skip_blanks(cursor);
    return true;
}

/* Whether a comma separates the number from its unit, as in `0.000,kg`. */
static bool is_before_unit(const char *comma)
{
    if (*comma != ',')
        return false;
    comma += 1 + strspn(comma + 1, " ");
    return isalpha((unsigned char)*comma);
}

/* Reads the number, with its sign possibly separated by blanks. */
static bool take_number(struct cursor *cursor)
{
    char text[MAX_LINE];
    size_t n = 0, digits = 0;
    const char *c = cursor->at;
    if (*c == '+' || *c == '-') {
        text[n++] = *c++;
        while (*c == ' ')
            c++;
    }
    bool point = false;
    for (;; c++) {
        if (isdigit((unsigned char)*c)) {
            digits++;
            text[n++] = *c;
        } else if (!point && (*c == '.' || *c == ',') && !is_before_unit(c)) {
            const bool wanted = cursor->cell->decimal_comma ? *c == ',' : *c == '.';
            if (!wanted) {
                reject(cursor,
                       cursor->cell->decimal_comma
                           ? "a point in a number, but the rig file sets load_cell.decimal_comma"
                           : "a comma in or after a number: set load_cell.decimal_comma, or "
                             "load_cell.delimiter and load_cell.column");
                return false;
            }
            point = true;
            text[n++] = '.';
        } else {
            break;
        }
    }
    if (digits == 0) {
        reject(cursor, "expected a number");
        return false;
    }
    /* An exponent needs digits: the E of `12.3 E` is a mark. */
    if (*c == 'e' || *c == 'E') {
        const size_t sign = c[1] == '+' || c[1] == '-';
        if (isdigit((unsigned char)c[1 + sign])) {
            const size_t length = 1 + sign + strspn(c + 1 + sign, "0123456789");
            memcpy(text + n, c, length);
            n += length;
            c += length;
        }
    }
    text[n] = '\0';
    cursor->at = c;
    if (!wb_number_parse(text, &cursor->reading->value)) {
        reject(cursor, "the number is malformed or too large");
        return false;
    }
    return true;
}

static bool is_known_unit(const char *word)
{
    double newtons;
    return wb_line_unit_factor(word, WB_STANDARD_GRAVITY, &newtons);
}

/* Interprets a mark after the number or unit: `?`, check-weighing (low, good, high) or stability
 * letters. False if it is not a mark. */
static bool take_mark(struct wb_line_reading *reading, const char *mark)
{
    const char *rest = mark;
    if (strchr("LGH", *rest) && rest[1])
        rest++;
    if (strcmp(mark, "?") == 0 || strcmp(rest, "U") == 0)
        reading->unstable = true;
    else if (strcmp(rest, "E") == 0)
        reading->kind = WB_LINE_OVERLOAD;
    else
        return strcmp(rest, "S") == 0;
    return true;
}

/* Interprets a word after the number: a unit, a unit with marks attached, or a mark. */
static bool take_word(struct cursor *cursor, const char *word, size_t n)
{
    struct wb_line_reading *const reading = cursor->reading;
    char head[sizeof reading->unit], tail[sizeof head];
    if (n >= sizeof head)
        return false;
    if (!reading->unit[0]) {
        /* Find the longest beginning that is a unit and leaves a mark: `GLS` is G and LS. */
        for (size_t k = n; k > 0; k--) {
            snprintf(head, sizeof head, "%.*s", (int)k, word);
            snprintf(tail, sizeof tail, "%.*s", (int)(n - k), word + k);
            if (is_known_unit(head) && (k == n || take_mark(reading, tail))) {
                strcpy(reading->unit, head);
                return true;
            }
        }
    }
    snprintf(head, sizeof head, "%.*s", (int)n, word);
    if (take_mark(reading, head))
        return true;
    if (reading->unit[0])
        return false;
    /* An unknown unit is stored for the message, and for rig files that set the unit. */
    strcpy(reading->unit, head);
    return true;
}

/* Reads unit and marks up to the end of the line. */
static void take_rest(struct cursor *cursor)
{
    skip_blanks(cursor);
    cursor->at += is_before_unit(cursor->at);
    for (int words = 0;; words++) {
        skip_blanks(cursor);
        if (*cursor->at == '\0')
            return;
        size_t n = 0;
        while (isalpha((unsigned char)cursor->at[n]) || cursor->at[n] == '/' ||
               cursor->at[n] == '%')
            n++;
        if (n == 0 && *cursor->at == '?')
            n = 1;
        if (n == 0 || words == 3) {
            reject(cursor, "more than one value in the line: set load_cell.delimiter and "
                           "load_cell.column");
            return;
        }
        if (!take_word(cursor, cursor->at, n)) {
            reject(cursor, "expected a unit or a mark after the number");
            return;
        }
        cursor->at += n;
    }
}

/* Selects the configured column of the line, in place. */
static bool select_column(char **text, const struct wb_rig_load_cell *cell)
{
    char *field = *text;
    for (int i = 1; i < cell->column; i++) {
        field = strchr(field, cell->delimiter);
        if (!field)
            return false;
        field++;
    }
    char *const end = strchr(field, cell->delimiter);
    if (end)
        *end = '\0';
    *text = field;
    return true;
}

/* Copies the line as clean text: blanks trimmed, the micro sign as `u`. False if it contains bytes
 * that are not text, or is too long. */
static bool clean(const char *bytes, size_t length, char text[MAX_LINE])
{
    const struct wb_span line = wb_cells_strip((struct wb_span){bytes, length});
    size_t n = 0;
    for (size_t i = 0; i < line.n; i++) {
        const unsigned char c = (unsigned char)line.text[i];
        if (n + 1 >= MAX_LINE)
            return false;
        if (c == 0xC2 && i + 1 < line.n && (unsigned char)line.text[i + 1] == 0xB5)
            continue; /* first byte of the micro sign in UTF-8 */
        if (c == 0xB5)
            text[n++] = 'u';
        else if (c == '\t' || (c >= 0x20 && c < 0x7f))
            text[n++] = (char)c;
        else
            return false;
    }
    text[n] = '\0';
    return true;
}

void wb_line_decode(const char *bytes, size_t length, const struct wb_rig_load_cell *cell,
                    struct wb_line_reading *reading)
{
    char line[MAX_LINE];
    char *text = line;
    struct cursor cursor = {.cell = cell, .reading = reading};
    memset(reading, 0, sizeof *reading);
    reading->value = (double)NAN;
    if (!clean(bytes, length, line)) {
        reject(&cursor, "the bytes are not text, or too many: check baud rate and parity in "
                        "load_cell.address");
        return;
    }
    if (line[0] == '\0')
        return;
    reading->kind = WB_LINE_VALUE;
    look_for_tokens(line, cell, reading);
    if (reading->kind == WB_LINE_OVERLOAD)
        return;
    if (cell->delimiter && !select_column(&text, cell)) {
        reject(&cursor, "the line has fewer columns than load_cell.column");
        return;
    }
    cursor.at = text;
    skip_blanks(&cursor);
    /* Lines that Radwag balances print by themselves begin with the mark of stability. */
    take_sign(&cursor, "?^v");
    while (take_status(&cursor) || take_label(&cursor))
        ;
    if (reading->kind == WB_LINE_OVERLOAD || !take_number(&cursor))
        return;
    take_rest(&cursor);
}
