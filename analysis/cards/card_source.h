/* What a card is made of: the properties of a wire, with where they come from.
 *
 * A file is recognised by its content: a wire file (fe/model/wire.h) has `name` and `properties`, a
 * properties file (analysis/calibration/properties/properties.h) has `wire`. What a wire file does
 * not say (intervals, range, datasets) is unknown: NaN, 0 or "".
 */
#ifndef WB_ANALYSIS_CARDS_CARD_SOURCE_H
#define WB_ANALYSIS_CARDS_CARD_SOURCE_H

#include <stdbool.h>

#include "analysis/calibration/properties/properties.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/status.h"
#include "base/text.h"

struct wb_card_source {
    struct wb_properties properties;
    bool is_wire_file;           /* else a properties file */
    char file[96];               /* last part of its path */
    char sha256[WB_SHA256_TEXT]; /* of it */
    char stated[160];            /* what a wire file says of its numbers' source; "" nothing */
};

/* Reads either file. Errors name file, line and key; a wire without properties, and what is neither
 * of the two, is WB_ERR_FORMAT. */
WB_MUST_CHECK enum wb_status wb_card_source_read(struct wb_card_source *source, const char *path);
/* The same of its text; `origin` stands for the path. `why` receives the reason; NULL: it is
 * logged.
 */
WB_MUST_CHECK enum wb_status wb_card_source_parse(struct wb_card_source *source, const char *text,
                                                  const char *origin, struct wb_reason *why);

/* Of the virgin section, N m2, with its interval of 95 %: as calibrated; else of E and, where there
 * are several samples, its standard uncertainty (Student's t). */
struct wb_estimate wb_card_source_rigidity(const struct wb_card_source *source);

/* Up to which the law is used, 1/m: the data's largest, or where that is unknown the curvature that
 * strains the outer fibre by 2 %. */
double wb_card_source_curvature(const struct wb_card_source *source);

/* Whether the data support what the law says of the unloading. */
bool wb_card_source_has_way_back(const struct wb_card_source *source);

/* "MADE OF VIRTUAL DATA: ..." or of simulated data; NULL: of neither, as far as the file says. */
const char *wb_card_source_warning(const struct wb_card_source *source);

/* Appends what every card says of its source, each line behind `prefix`: the warning first, then
 * kind of card, units, wire, law, interval, curvature range, hardening rule, test conditions, and
 * checksums. No line holds "--", which ends a comment of XML. */
void wb_card_source_append(const struct wb_card_source *source, const char *kind,
                           const char *prefix, struct wb_text *text);

#endif
