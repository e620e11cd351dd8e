/* Of the reader of test pieces, for its tests. */
#ifndef WB_ANALYSIS_DATASET_TEST_PIECE_PRIVATE_H
#define WB_ANALYSIS_DATASET_TEST_PIECE_PRIVATE_H

#include "analysis/dataset/test_piece.h"

/* As wb_test_piece_read(), from text; `origin` stands for the file in errors, and wires are looked
 * for beside it. */
WB_MUST_CHECK enum wb_status wb_test_piece_parse(const char *text, const char *origin,
                                                 enum wb_test_kind kind,
                                                 struct wb_test_piece *piece,
                                                 struct wb_reason *why);

#endif
