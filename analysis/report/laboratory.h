/* Fields that ISO/IEC 17025:2017, clause 7.8.2, requires on a report beside its results: who tested
 * what, for whom, where, when and how. A campaign file says it under `laboratory`:
 *
 *     laboratory:
 *       report: WB-2026-014             # number of the report, on each of its pages
 *       name: Test house
 *       address: 1 Main Street, Town
 *       place: room 12
 *       customer: Maker, who is asked for at ...
 *       item: 6 pieces of wire X, reel 7, cut by the customer
 *       item_state: as delivered, straight
 *       received: 2026-11-02
 *       tested_from: 2026-11-20
 *       tested_until: 2026-11-20
 *       issued: 2026-11-23
 *       method: cantilever bending ...
 *       deviations: none
 *       sampling: ...                   # optional, as the next: where there was one
 *       external: ...
 *       environment: 22.5 to 23.5 degC, 45 to 50 % relative humidity
 *       authorised_by: N. N., head of the laboratory
 *       decision_rule: simple           # optional: simple or guarded (verdict.h)
 *       amends:                         # optional: the report that this one replaces
 *         report: WB-2026-011
 *         issued: 2026-11-10
 *         why: the diameter of the wire was wrong
 *
 * Only `report` is required: missing fields are listed on the report.
 */
#ifndef WB_ANALYSIS_REPORT_LABORATORY_H
#define WB_ANALYSIS_REPORT_LABORATORY_H

#include <stdbool.h>

#include "analysis/keys/keys.h"
#include "analysis/report/document.h"
#include "analysis/report/verdict.h"
#include "base/config.h"
#include "base/json.h"
#include "base/status.h"

struct wb_laboratory {
    bool is_given;
    char report[80]; /* its number */
    char name[200], address[300], place[300], customer[400], item[600], item_state[400];
    char received[16], tested_from[16], tested_until[16], issued[16]; /* YYYY-MM-DD */
    char method[800], deviations[800], sampling[600], external[600], environment[400];
    char authorised_by[300];
    enum wb_verdict_rule rule;
    struct {
        char report[80], issued[16], why[800];
    } amends; /* `report` "": the report replaces none */
};

/* Reads the node (NULL: nothing is given). Dates must be dates, in their order; an amendment has a
 * number of its own. `has_uncertainties`: of what the campaign's limits bound, which the rule
 * `guarded` needs. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_laboratory_read(const struct wb_config_node *node,
                                                bool has_uncertainties,
                                                struct wb_laboratory *laboratory);

/* How many required fields are missing. */
int wb_laboratory_missing(const struct wb_laboratory *laboratory);

/* Puts number, amendment, fields and missing fields before everything else in a document, and the
 * end of the report behind it; without fields, one line that it is not a test report. */
void wb_laboratory_put_pages(struct wb_document *document, const struct wb_laboratory *laboratory);

/* Keys of `laboratory` in report.json. */
extern const struct wb_keys wb_laboratory_keys;

/* Adds `laboratory` to the numbers: the fields that are given, `missing`; nothing where none is. */
void wb_laboratory_put_numbers(struct wb_json *root, const struct wb_laboratory *laboratory);

#endif
