/* Cards as tables for programs of one's own: what is known of a wire under bending, as JSON and as
 * CSV. docs/file-formats.md has the schema. */
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
