/* Common parts of the pages of all reports: cells of tables, escaped text, properties of a wire,
 * the chapter on provenance.
 */
#ifndef WB_ANALYSIS_REPORT_PAGES_H
#define WB_ANALYSIS_REPORT_PAGES_H

#include "analysis/report/campaign.h"
#include "analysis/report/document.h"
#include "fe/material/material.h"

/* Adds a cell of markup to the row that was begun; `wb_pages_cell_plain` escapes text from
 * files. */
void wb_pages_cell(struct wb_document_table *table, enum wb_document_tone tone, const char *format,
                   ...) __attribute__((format(printf, 3, 4)));
void wb_pages_cell_plain(struct wb_document_table *table, enum wb_document_tone tone,
                         const char *text);
/* The first 16 of a checksum's 64 digits, which report.json has. */
void wb_pages_cell_checksum(struct wb_document_table *table, const char *sha256);
/* Decimals, at most six, that give a positive number three digits that mean something; 0 of any
 * other. */
int wb_pages_decimals(double value);
/* A number with `decimals`, or an en dash when it is not finite. */
void wb_pages_cell_number(struct wb_document_table *table, double value, int decimals);
/* A number with three digits that mean something. */
void wb_pages_cell_rounded(struct wb_document_table *table, double value);
/* "1.2 to 3.4", or an en dash when an end is not finite. */
void wb_pages_cell_range(struct wb_document_table *table, enum wb_document_tone tone, double low,
                         double high, int decimals);
/* A number with a tone, where there is a limit: whether it is kept. */
void wb_pages_cell_judged(struct wb_document_table *table, double value, int decimals,
                          bool is_limited, bool is_kept);
/* Escapes into a buffer, cut where it ends (never within an entity). Returns the buffer. */
char *wb_pages_escape(char *buffer, size_t size, const char *raw);

/* Appends a number with a real minus sign, where there is one. */
void wb_pages_append_number(struct wb_text *text, double value, int decimals);

/* Appends plain text as markup, with symbols and powers of ten typeset: "sigma_Y 3.5 MPa",
 * "C1", "gamma2", "1.2e-03", "+-". */
void wb_pages_append_symbols(struct wb_text *text, const char *plain);

/* Adds formatted markup as a block of that kind: a paragraph, a notice or an item. */
void wb_pages_put(struct wb_document *document, enum wb_document_kind kind,
                  enum wb_document_tone tone, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* The same of a text of markup, which is released. */
void wb_pages_put_text(struct wb_document *document, enum wb_document_kind kind,
                       enum wb_document_tone tone, struct wb_text *text);
/* Adds an item of two plain texts, each behind markup: "<b>", name, "</b>: ", problem. */
void wb_pages_item(struct wb_document *document, enum wb_document_tone tone, const char *markup,
                   const char *plain, const char *more_markup, const char *more_plain);

/* Starts a table with a caption of formatted markup, or of a text, which is released. */
struct wb_document_table *wb_pages_table(struct wb_document *document, int n_columns,
                                         const struct wb_document_column *columns,
                                         const char *caption, ...)
    __attribute__((format(printf, 4, 5)));
struct wb_document_table *wb_pages_start_table(struct wb_document *document,
                                               struct wb_text *caption, int n_columns,
                                               const struct wb_document_column *columns);
/* Begins a row with a cell of plain text. */
void wb_pages_row(struct wb_document_table *table, bool begins_group, const char *plain);
/* Adds a row of a name (markup) and a formatted value of plain text. */
void wb_pages_row_pair(struct wb_document_table *table, enum wb_document_tone name_tone,
                       const char *name, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Starts the document of a report. The program's version stands on every page, with the origin of
 * the data: "virtual rig" (NULL: measured). `date_utc` as of wb_document_init(). */
void wb_pages_start(struct wb_document *document, const char *kind,
                    const struct wb_campaign *campaign, const char *subtitle, const char *origin,
                    const char *date_utc);

/* The heading of a report's last chapter: campaign, checksum, program, the command that makes it
 * again, notes. `same` names its inputs: "recordings". */
void wb_pages_put_origin(struct wb_document *document, const struct wb_campaign *campaign,
                         const char *same);

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
