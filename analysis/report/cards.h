/* The cards of a report: of each law that it calibrated the properties file, as `calibrate` writes
 * it, and beside it a card of every kind (analysis/cards/card.h), made of that file.
 */
#ifndef WB_ANALYSIS_REPORT_CARDS_H
#define WB_ANALYSIS_REPORT_CARDS_H

#include <stdbool.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/report/document.h"
#include "base/status.h"
#include "base/text.h"

struct wb_cards_file {
    char name[128]; /* relative to the report's folder: "cards/type1.calculix.inp" */
    struct wb_text bytes;
};

struct wb_cards_law {                /* one, with all its files */
    char stem[80];                   /* "type1" */
    double curvature;                /* 1/m, up to which its data reach */
    bool has_way_back;               /* the data support it */
    struct wb_text endings, missing; /* ".yaml, .calculix.inp"; the kinds without a card, and why */
};

struct wb_cards {
    int n;
    size_t capacity;
    struct wb_cards_file *files; /* (n), owned */
    int n_laws;
    struct wb_cards_law *laws; /* (n_laws), owned */
};

/* Adds the files of a law by the text of its properties, which becomes the list's; they are named
 * by `wire`, whose other characters than letters, digits, '.', '_' and '-' become '-', and of whose
 * equals the second is NAME-2. A law that a program cannot express is left out, with a message: a
 * kind that has no place for the law, or all where the numbers make no properties file. */
WB_MUST_CHECK enum wb_status wb_cards_add(struct wb_cards *cards, const char *wire,
                                          struct wb_text *properties);
/* The same of a law that was fitted to one dataset of a name and checksum. */
WB_MUST_CHECK enum wb_status wb_cards_add_fit(struct wb_cards *cards,
                                              const struct wb_calibrate_result *result,
                                              const struct wb_calibrate_settings *settings,
                                              const char *dataset, const char *sha256);
void wb_cards_release(struct wb_cards *cards); /* accepts a zeroed one */

/* Appends the chapter that says which cards lie beside the report and for what they hold; nothing
 * where there are none. */
void wb_cards_put_pages(struct wb_document *document, const struct wb_cards *cards);

#endif
