/* Source of a card: the properties of a wire, and their origin.
 *
 * A file is recognised by its content: a wire file (fe/model/wire.h) has `name` and `properties`, a
 * properties file (analysis/calibration/properties/properties.h) has `wire`. Values that a wire
 * file lacks (intervals, range, datasets) are unknown: NaN, 0 or "".
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
    char sha256[WB_SHA256_TEXT]; /* of the file */
    char stated[160]; /* source of the values as stated in a wire file; "" if not stated */
};

/* Reads either file. Messages name file, line and key. WB_ERR_FORMAT for a wire without properties,
 * and for any other file. */
WB_MUST_CHECK enum wb_status wb_card_source_read(struct wb_card_source *source, const char *path);
/* The same for the text of a file; `origin` replaces the path in messages. `why` receives the
 * reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_card_source_parse(struct wb_card_source *source, const char *text,
                                                  const char *origin, struct wb_reason *why);

/* Flexural rigidity EI of the virgin section, N m2, with its interval of 95 %: as calibrated; else
 * from E and, with several samples, its standard uncertainty (Student's t). */
struct wb_estimate wb_card_source_rigidity(const struct wb_card_source *source);

/* Curvature up to which the law is used, 1/m: the largest of the data, or if that is unknown the
 * curvature with a strain of 2 % at the outer fibre. */
double wb_card_source_curvature(const struct wb_card_source *source);

/* Whether the data support the law's unloading. */
bool wb_card_source_has_unloading(const struct wb_card_source *source);

/* "MADE OF VIRTUAL DATA: ..." or the same for simulated data; NULL: neither, or not stated. */
const char *wb_card_source_warning(const struct wb_card_source *source);

/* Appends the source of a card, each line after `prefix`: the warning first, then kind of card,
 * units, wire, law, interval, curvature range, hardening rule, test conditions, and checksums. No
 * line contains "--", which is not permitted in a comment of XML. */
void wb_card_source_append(const struct wb_card_source *source, const char *kind,
                           const char *prefix, struct wb_text *text);

#endif
