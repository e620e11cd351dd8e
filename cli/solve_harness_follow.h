/* `wirebench solve harness --follow`. */
#ifndef WB_CLI_SOLVE_HARNESS_FOLLOW_H
#define WB_CLI_SOLVE_HARNESS_FOLLOW_H

#include "analysis/harness/harness_run.h"
#include "base/status.h"

/* Answers the lines of standard input until it ends, `quit` or Ctrl-C. */
WB_MUST_CHECK enum wb_status wb_solve_harness_follow(const struct wb_harness_plan *plan,
                                                     const struct wb_harness_settings *settings);

#endif
