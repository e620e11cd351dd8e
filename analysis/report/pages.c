#include "analysis/report/pages.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

enum {
    CELL = 360 /* bytes of a cell's text */
};

const struct wb_pages_property wb_pages_properties[4] = {
    {"Young's modulus", "<i>E</i>", "MPa", "youngs_modulus_MPa", WB_MPA, 0},
    {"Yield stress", "<i>\xcf\x83</i><sub>Y</sub>", "MPa", "yield_stress_MPa", WB_MPA, 2},
    {"Strength coefficient", "<i>K</i>", "MPa", "strength_coefficient_MPa", WB_MPA, 0},
    {"Hardening exponent", "<i>n</i>", "1", "hardening_exponent", 1.0, 3},
};

double wb_pages_value(const struct wb_material *material, int property)
{
    const double values[] = {material->youngs_modulus, material->yield_stress,
                             material->strength_coefficient, material->hardening_exponent};
    return values[property];
}

const char *wb_pages_plural(int n, const char *one, const char *many)
{
    return n == 1 ? one : many;
}

const char *wb_pages_paper_figure(char text[48], const char *number)
{
    text[0] = '\0';
    if (number[0])
        snprintf(text, 48, " (the paper's Fig. %s)", number);
    return text;
}

/* Symbols of plain text and how they are typeset; an index of digits may follow. */
static const char *const symbols[][2] = {
    {"sigma_Y", "<i>\xcf\x83</i><sub>Y</sub>"},
    {"E_eff", "<i>E</i><sub>eff</sub>"},
    {"gamma", "<i>\xce\xb3</i>"},
    {"EI", "<i>EI</i>"},
    {"E", "<i>E</i>"},
    {"K", "<i>K</i>"},
    {"M", "<i>M</i>"},
    {"Q", "<i>Q</i>"},
    {"C", "<i>C</i>"},
    {"b", "<i>b</i>"},
    {"n", "<i>n</i>"},
    {"+-", "\xc2\xb1"},
    {"mm2", "mm\xc2\xb2"},
};

/* Appends a symbol that is a whole word; returns its length in the plain text, 0: no symbol. */
static size_t append_symbol(struct wb_text *text, const char *plain)
{
    for (size_t i = 0; i < WB_COUNT(symbols); i++) {
        const size_t n = strlen(symbols[i][0]);
        if (strncmp(plain, symbols[i][0], n) != 0)
            continue;
        const size_t index = strspn(plain + n, "0123456789");
        const char next = plain[n + index];
        if (isalnum((unsigned char)next) || next == '_' || next == '-' || next == '\'' ||
            (next == '.' && isalnum((unsigned char)plain[n + index + 1])))
            continue; /* part of a longer word, or of a file's name */
        wb_text_append(text, "%s", symbols[i][1]);
        if (index > 0)
            wb_text_append(text, "<sub>%.*s</sub>", (int)index, plain + n);
        return n + index;
    }
    return 0;
}

/* Appends "1.13e-04" as a product with a power of ten; returns its length, 0: no such number. */
static size_t append_power(struct wb_text *text, const char *plain)
{
    const size_t digits = strspn(plain, "0123456789.");
    char *end;
    if (digits == 0 || plain[digits] != 'e' || !strchr("+-", plain[digits + 1]))
        return 0;
    const long exponent = strtol(plain + digits + 1, &end, 10);
    if (end == plain + digits + 1)
        return 0;
    wb_text_append(text, "%.*s\xc2\xb7", (int)digits, plain);
    wb_text_append(text, "10<sup>%s%ld</sup>", exponent < 0 ? "\xe2\x88\x92" : "", labs(exponent));
    return (size_t)(end - plain);
}

void wb_pages_append_symbols(struct wb_text *text, const char *plain)
{
    bool in_word = false;
    while (*plain) {
        size_t n = in_word ? 0 : append_symbol(text, plain);
        if (n == 0 && !in_word)
            n = append_power(text, plain);
        if (n == 0) {
            const char one[2] = {*plain, '\0'};
            if ((unsigned char)*plain < 0x80)
                wb_text_append_escaped(text, one);
            else
                wb_text_append_bytes(text, plain, 1);
            n = 1;
        }
        plain += n;
        in_word = isalnum((unsigned char)plain[-1]) || plain[-1] == '_' || plain[-1] == '.';
    }
}

/* Formatted text, for free(). */
static char *format_text(const char *format, va_list arguments)
{
    char *text;
    return vasprintf(&text, format, arguments) < 0 ? wb_memory_need(NULL) : text;
}

char *wb_pages_escape(char *buffer, size_t size, const char *raw)
{
    struct wb_text text = {0};
    size_t fits = 0; /* bytes of the characters before the last one */
    for (; *raw && text.length < size; raw++) {
        const bool begins_character = ((unsigned char)*raw & 0xc0) != 0x80;
        if (begins_character)
            fits = text.length;
        wb_text_append_escaped(&text, (const char[2]){*raw, '\0'});
    }
    if (text.length < size)
        fits = text.length;
    memcpy(buffer, wb_text_string(&text), fits);
    buffer[fits] = '\0';
    wb_text_release(&text);
    return buffer;
}

void wb_pages_cell(struct wb_document_table *table, enum wb_document_tone tone, const char *format,
                   ...)
{
    char text[CELL];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    wb_document_cell(table, tone, text);
}

void wb_pages_cell_plain(struct wb_document_table *table, enum wb_document_tone tone,
                         const char *text)
{
    char escaped[CELL];
    wb_document_cell(table, tone, wb_pages_escape(escaped, sizeof escaped, text));
}

void wb_pages_cell_checksum(struct wb_document_table *table, const char *sha256)
{
    wb_pages_cell(table, WB_TONE_PLAIN, "%.16s", sha256);
}

int wb_pages_decimals(double value)
{
    if (!(value > 0.0) || !isfinite(value))
        return 0;
    return (int)fmin(fmax(2.0 - floor(log10(value)), 0.0), 6.0);
}

/* A real minus sign; a number that rounds to zero has no sign. */
static const char *minus(double value, int decimals)
{
    return value < 0.0 && -value * pow(10.0, decimals) >= 0.5 ? "\xe2\x88\x92" : "";
}

void wb_pages_append_number(struct wb_text *text, double value, int decimals)
{
    wb_text_append(text, "%s%.*f", minus(value, decimals), decimals, fabs(value));
}

static void put_number(struct wb_document_table *table, enum wb_document_tone tone, double value,
                       int decimals)
{
    if (isfinite(value))
        wb_pages_cell(table, tone, "%s%.*f", minus(value, decimals), decimals, fabs(value));
    else
        wb_document_cell(table, WB_TONE_QUIET, "\xe2\x80\x93");
}

void wb_pages_cell_number(struct wb_document_table *table, double value, int decimals)
{
    put_number(table, WB_TONE_PLAIN, value, decimals);
}

void wb_pages_cell_range(struct wb_document_table *table, enum wb_document_tone tone, double low,
                         double high, int decimals)
{
    if (isfinite(low) && isfinite(high))
        wb_pages_cell(table, tone, "%s%.*f to %s%.*f", minus(low, decimals), decimals, fabs(low),
                      minus(high, decimals), decimals, fabs(high));
    else
        wb_pages_cell_number(table, (double)NAN, 0);
}

void wb_pages_cell_judged(struct wb_document_table *table, double value, int decimals,
                          bool is_limited, bool is_kept)
{
    const enum wb_document_tone judged = is_kept ? WB_TONE_GOOD : WB_TONE_WARNING;
    put_number(table, is_limited ? judged : WB_TONE_PLAIN, value, decimals);
}

void wb_pages_cell_rounded(struct wb_document_table *table, double value)
{
    wb_pages_cell_number(table, value, wb_pages_decimals(value));
}

void wb_pages_row(struct wb_document_table *table, bool begins_group, const char *plain)
{
    wb_document_row(table, begins_group);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, plain);
}

void wb_pages_row_pair(struct wb_document_table *table, enum wb_document_tone name_tone,
                       const char *name, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *const value = format_text(format, arguments);
    va_end(arguments);
    wb_document_row(table, false);
    wb_document_cell(table, name_tone, name);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, value);
    free(value);
}

void wb_pages_put(struct wb_document *document, enum wb_document_kind kind,
                  enum wb_document_tone tone, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    char *const markup = format_text(format, arguments);
    va_end(arguments);
    wb_document_text(document, kind, tone, markup);
    free(markup);
}

void wb_pages_put_text(struct wb_document *document, enum wb_document_kind kind,
                       enum wb_document_tone tone, struct wb_text *text)
{
    wb_document_text(document, kind, tone, wb_text_string(text));
    wb_text_release(text);
}

struct wb_document_table *wb_pages_table(struct wb_document *document, int n_columns,
                                         const struct wb_document_column *columns,
                                         const char *caption, ...)
{
    va_list arguments;
    va_start(arguments, caption);
    char *const markup = format_text(caption, arguments);
    va_end(arguments);
    struct wb_document_table *const table = wb_document_table(document, markup, n_columns, columns);
    free(markup);
    return table;
}

struct wb_document_table *wb_pages_start_table(struct wb_document *document,
                                               struct wb_text *caption, int n_columns,
                                               const struct wb_document_column *columns)
{
    struct wb_document_table *const table =
        wb_document_table(document, wb_text_string(caption), n_columns, columns);
    wb_text_release(caption);
    return table;
}

void wb_pages_item(struct wb_document *document, enum wb_document_tone tone, const char *markup,
                   const char *plain, const char *more_markup, const char *more_plain)
{
    struct wb_text text = {0};
    wb_text_append(&text, "%s", markup);
    wb_text_append_escaped(&text, plain);
    wb_text_append(&text, "%s", more_markup);
    wb_text_append_escaped(&text, more_plain);
    wb_pages_put_text(document, WB_BLOCK_ITEM, tone, &text);
}

void wb_pages_start(struct wb_document *document, const char *kind,
                    const struct wb_campaign *campaign, const char *subtitle, const char *origin,
                    const char *date_utc)
{
    char footer[300];
    snprintf(footer, sizeof footer, "wirebench %s, revision %s%s%s", wb_version(),
             wb_version_revision(), origin ? " \xc2\xb7 " : "", origin ? origin : "");
    wb_document_init(document, kind, campaign->title, subtitle, footer, date_utc);
}

void wb_pages_put_origin(struct wb_document *document, const struct wb_campaign *campaign,
                         const char *same)
{
    char name[600], escaped[2200], command[400];
    wb_document_new_page(document);
    wb_document_heading(document, 1, "provenance", "Provenance");
    wb_pages_put(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN,
                 "Campaign <tt>%s</tt>, SHA-256 <tt>%s</tt>. Written by wirebench %s, revision "
                 "<tt>%s</tt>. The same %s and the same revision give the same bytes:",
                 wb_pages_escape(name, sizeof name, campaign->name), campaign->sha256, wb_version(),
                 wb_version_revision(), same);
    snprintf(command, sizeof command, "wirebench report %s -o DIR", campaign->name);
    wb_document_code(document, command);
    if (campaign->notes[0])
        wb_document_paragraph(document, wb_pages_escape(escaped, sizeof escaped, campaign->notes));
}
