/* Cards: the law of a wire as input of other programs.
 *
 * A card is one file, made from the properties of a wire (card_source.h) by a kind: a row of
 * wb_card_kinds. To add one, write its function in a file of this folder, and its row in card.c;
 * command, report and tests use the table.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_H
#define WB_ANALYSIS_CARDS_CARD_H

#include <stddef.h>

#include "analysis/cards/card_source.h"
#include "base/setting.h"
#include "base/status.h"
#include "base/text.h"

struct wb_card_settings {
    double curvature; /* 1/m at which a linear target uses the secant stiffness; 0: virgin wire */
    double length;    /* m, of the wire; 0: that of the calibration's specimens, else 0.1 m */
    int segments;     /* of a chain */
    double damping_ratio; /* of a chain's first bending mode, 1 */
};

struct wb_card_kind {
    const char *name;    /* "calculix" */
    const char *summary; /* for --help */
    const char *ending;  /* of its files, "calculix.inp" */
    unsigned place;      /* one bit: the rows of the settings that apply */
    /* Appends the card. WB_ERR_UNSUPPORTED for a law or wire that the target cannot represent;
     * `why` receives the reason; NULL: it is logged. */
    enum wb_status (*write)(const struct wb_card_source *source,
                            const struct wb_card_settings *settings, struct wb_text *text,
                            struct wb_reason *why);
};

enum {
    WB_CARD_KINDS = 5
};
extern const struct wb_card_kind wb_card_kinds[WB_CARD_KINDS];
extern const struct wb_setting_table wb_card_table; /* of struct wb_card_settings */
extern const char *const wb_card_places[];          /* names of the places by bit, for messages */

/* The kind of a name; NULL for an unknown name, with a message that lists the names. */
const struct wb_card_kind *wb_card_find(const char *name);

/* Appends the card of a kind; WB_ERR_ARGUMENT for settings out of range, WB_ERR_UNSUPPORTED.
 * `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_card_write(const struct wb_card_kind *kind,
                                           const struct wb_card_source *source,
                                           const struct wb_card_settings *settings,
                                           struct wb_text *text, struct wb_reason *why);

#endif
