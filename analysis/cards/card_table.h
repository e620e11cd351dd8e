/* Cards as tables for the user's own programs: bending properties of a wire as JSON and as CSV. The
 * schema is in docs/file-formats.md. */
#ifndef WB_ANALYSIS_CARDS_CARD_TABLE_H
#define WB_ANALYSIS_CARDS_CARD_TABLE_H

#include "analysis/cards/card.h"

/* As wb_card_kind.write. */
WB_MUST_CHECK enum wb_status wb_card_table_json(const struct wb_card_source *source,
                                                const struct wb_card_settings *settings,
                                                struct wb_text *text, struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_card_table_csv(const struct wb_card_source *source,
                                               const struct wb_card_settings *settings,
                                               struct wb_text *text, struct wb_reason *why);

#endif
