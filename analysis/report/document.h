/* The report's content, once: headings, paragraphs, notices, tables and figures in order. The PDF
 * and the HTML page are two views of it, so they always say the same.
 *
 * Text is the markup that Pango and HTML share: <b>, <i>, <sub>, <sup>, <tt>, and &amp; &lt; &gt;.
 * Kind, title, subtitle, footer, number, headings and code are plain text.
 * Builders copy text and return nothing. Figures are borrowed and must outlive the document.
 */
#ifndef WB_ANALYSIS_REPORT_DOCUMENT_H
#define WB_ANALYSIS_REPORT_DOCUMENT_H

#include <stdbool.h>

#include "analysis/plot/figure.h"

enum wb_document_tone {
    WB_TONE_PLAIN,
    WB_TONE_GOOD,    /* a limit is kept */
    WB_TONE_WARNING, /* a limit is exceeded, something is missing */
    WB_TONE_ORIGIN,  /* where the data come from: the virtual rig */
    WB_TONE_QUIET    /* of less weight */
};

enum wb_document_kind {
    WB_BLOCK_HEADING,
    WB_BLOCK_PARAGRAPH,
    WB_BLOCK_NOTICE, /* a paragraph in a box */
    WB_BLOCK_ITEM,   /* of a list */
    WB_BLOCK_CODE,   /* plain text, not markup */
    WB_BLOCK_TABLE,
    WB_BLOCK_FIGURES,  /* one, or two side by side */
    WB_BLOCK_NEW_PAGE, /* where there are pages, and this one is at least half full */
    WB_BLOCK_ROOM      /* the same, and less than `room` is left on this one */
};

struct wb_document_column {
    const char *heading; /* markup */
    bool right;          /* numbers stand to the right */
    bool monospace;
    bool wraps; /* its text is wrapped when the table is too wide */
};

struct wb_document_cell {
    char *text; /* markup; owned */
    enum wb_document_tone tone;
};

#define WB_DOCUMENT_COLUMNS 11

struct wb_document_table {
    char *caption; /* NULL: none */
    int n_columns, n_rows, capacity;
    int n_cells;                                            /* of the last row */
    struct wb_document_column columns[WB_DOCUMENT_COLUMNS]; /* headings owned */
    struct wb_document_cell *cells;                         /* (n_rows x n_columns) */
    bool *begins_group;                                     /* (n_rows) a rule stands above */
};

struct wb_document_block {
    enum wb_document_kind kind;
    enum wb_document_tone tone;
    int level;    /* of a heading: 1, 2 */
    double room;  /* points */
    char *text;   /* owned */
    char *anchor; /* of a heading; owned */
    struct wb_document_table *table;
    const struct wb_figure *figures[2];
    char *captions[2];
};

struct wb_document {
    char *kind;                      /* of report: "Calibration report" */
    char *title, *subtitle, *footer; /* footer: on every page */
    char *number;                    /* of the report, on every page; NULL: none */
    char *date_utc;                  /* of the document: of its latest data; "" unknown */
    int n, n_figures;
    size_t capacity;
    struct wb_document_block *blocks;
};

/* Starts an empty document. Release it also after a failure; a zeroed one may be released. */
void wb_document_init(struct wb_document *document, const char *kind, const char *title,
                      const char *subtitle, const char *footer, const char *date_utc);
void wb_document_release(struct wb_document *document);

/* Gives the report a number. */
void wb_document_set_number(struct wb_document *document, const char *number);
/* Moves the blocks from the index `first` on before all others. */
void wb_document_move_to_front(struct wb_document *document, int first);

/* `anchor`: letters, digits and '-'; unique, or "" for none. */
void wb_document_heading(struct wb_document *document, int level, const char *anchor,
                         const char *text);
/* A paragraph, a notice or an item. */
void wb_document_text(struct wb_document *document, enum wb_document_kind kind,
                      enum wb_document_tone tone, const char *markup);
void wb_document_paragraph(struct wb_document *document, const char *markup);
void wb_document_notice(struct wb_document *document, enum wb_document_tone tone,
                        const char *markup);
void wb_document_item(struct wb_document *document, enum wb_document_tone tone, const char *markup);
void wb_document_code(struct wb_document *document, const char *text);
void wb_document_new_page(struct wb_document *document);
/* Keeps what follows together: a new page unless so many points are left on this one. */
void wb_document_need_room(struct wb_document *document, double points);

/* Captions get "Figure N." before them. The second figure may be NULL. */
void wb_document_figures(struct wb_document *document, const struct wb_figure *first,
                         const char *first_caption, const struct wb_figure *second,
                         const char *second_caption);

/* A table of at most WB_DOCUMENT_COLUMNS columns; the handle lives as long as the document. */
struct wb_document_table *wb_document_table(struct wb_document *document, const char *caption,
                                            int n_columns,
                                            const struct wb_document_column *columns);
/* Begins a row; cells that are not added to it stay empty. */
void wb_document_row(struct wb_document_table *table, bool begins_group);
/* Adds the next cell of the row that was begun; one too many is dropped. */
void wb_document_cell(struct wb_document_table *table, enum wb_document_tone tone,
                      const char *markup);

#endif
