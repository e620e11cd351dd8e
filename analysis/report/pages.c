#include "analysis/report/pages.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

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

char *wb_pages_escape(char *buffer, size_t size, const char *raw)
{
    struct wb_text text = {0};
    wb_text_append_escaped(&text, raw);
    size_t length = strlen(wb_text_string(&text));
    if (length >= size) {
        length = size - 1;
        /* Not within an entity, and not within a character of several bytes. */
        const char *const string = wb_text_string(&text);
        for (size_t back = 0; back < 7 && back < length; back++) {
            if (string[length - 1 - back] == ';')
                break;
            if (string[length - 1 - back] == '&') {
                length -= back + 1;
                break;
            }
        }
        while (length > 0 && ((unsigned char)string[length] & 0xc0) == 0x80)
            length--;
    }
    memcpy(buffer, wb_text_string(&text), length);
    buffer[length] = '\0';
    wb_text_release(&text);
    return buffer;
}

void wb_pages_cell(struct wb_pages_row *row, enum wb_document_tone tone, const char *format, ...)
{
    if (row->n == WB_DOCUMENT_COLUMNS)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(row->cells[row->n], sizeof row->cells[0], format, arguments);
    va_end(arguments);
    row->tones[row->n++] = tone;
}

void wb_pages_cell_plain(struct wb_pages_row *row, enum wb_document_tone tone, const char *text)
{
    char escaped[WB_PAGES_CELL];
    wb_pages_cell(row, tone, "%s", wb_pages_escape(escaped, sizeof escaped, text));
}

void wb_pages_cell_number(struct wb_pages_row *row, double value, int decimals)
{
    /* What rounds to zero has no sign. */
    const bool negative = value < 0.0 && -value * pow(10.0, decimals) >= 0.5;
    if (isfinite(value))
        wb_pages_cell(row, WB_TONE_PLAIN, "%s%.*f", negative ? "\xe2\x88\x92" : "", decimals,
                      fabs(value));
    else
        wb_pages_cell(row, WB_TONE_QUIET, "\xe2\x80\x93");
}

void wb_pages_put_row(struct wb_document *document, struct wb_document_table *table,
                      bool begins_group, struct wb_pages_row *row)
{
    const char *cells[WB_DOCUMENT_COLUMNS] = {NULL};
    for (int i = 0; i < row->n; i++)
        cells[i] = row->cells[i];
    wb_document_row(document, table, begins_group, cells);
    for (int i = 0; i < row->n; i++)
        wb_document_tone_cell(table, i, row->tones[i]);
    row->n = 0;
}

void wb_pages_put_origin(struct wb_document *document, const char *campaign, const char *sha256,
                         const char *notes, const char *same)
{
    char text[2600], name[600], escaped[2200], command[400];
    wb_document_new_page(document);
    wb_document_heading(document, 1, "provenance", "Provenance");
    snprintf(text, sizeof text,
             "Campaign <tt>%s</tt>, SHA-256 <tt>%s</tt>. Written by wirebench %s, revision "
             "<tt>%s</tt>. The same %s and the same revision give the same bytes:",
             wb_pages_escape(name, sizeof name, campaign), sha256, wb_version(),
             wb_version_revision(), same);
    wb_document_paragraph(document, text);
    snprintf(command, sizeof command, "wirebench report %s -o DIR", campaign);
    wb_document_code(document, command);
    if (notes[0])
        wb_document_paragraph(document, wb_pages_escape(escaped, sizeof escaped, notes));
}
