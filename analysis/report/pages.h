/* What pages of all reports share: rows of tables, escaped text, properties of a wire, the chapter
 * on where everything comes from.
 */
#ifndef WB_ANALYSIS_REPORT_PAGES_H
#define WB_ANALYSIS_REPORT_PAGES_H

#include "analysis/report/document.h"
#include "fe/material/material.h"

#define WB_PAGES_CELL 360

/* One row of a table while it is written: cells by printf, in order. */
struct wb_pages_row {
    char cells[WB_DOCUMENT_COLUMNS][WB_PAGES_CELL];
    enum wb_document_tone tones[WB_DOCUMENT_COLUMNS];
    int n;
};

/* Adds a cell of markup; `wb_pages_cell_plain` escapes what comes from files. */
void wb_pages_cell(struct wb_pages_row *row, enum wb_document_tone tone, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void wb_pages_cell_plain(struct wb_pages_row *row, enum wb_document_tone tone, const char *text);
/* A number with `decimals`, or an en dash when it is not finite. */
void wb_pages_cell_number(struct wb_pages_row *row, double value, int decimals);
/* Adds the row to the table and clears it. */
void wb_pages_put_row(struct wb_document *document, struct wb_document_table *table,
                      bool begins_group, struct wb_pages_row *row);

/* Escapes into a buffer, cut where it ends (never within an entity). Returns the buffer. */
char *wb_pages_escape(char *buffer, size_t size, const char *raw);

/* The heading of a report's last chapter: campaign, checksum, program, the command that makes it
 * again, notes. `same` is what it was made from, "recordings". */
void wb_pages_put_origin(struct wb_document *document, const char *campaign, const char *sha256,
                         const char *notes, const char *same);

/* " (the paper's Fig. N)", or "" without a number. */
const char *wb_pages_paper_figure(char text[48], const char *number);

/* "1 recording", "2 recordings". */
const char *wb_pages_plural(int n, const char *one, const char *many);

/* A property's symbol, unit, decimals and value in that unit: 0 E, 1 sigma_Y, 2 K, 3 n. */
struct wb_pages_property {
    const char *name, *symbol, *unit, *key;
    double factor; /* unit to SI */
    int decimals;
};
extern const struct wb_pages_property wb_pages_properties[4];
double wb_pages_value(const struct wb_material *material, int property);

#endif
