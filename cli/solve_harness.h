/* `wirebench solve harness`. */
#ifndef WB_CLI_SOLVE_HARNESS_H
#define WB_CLI_SOLVE_HARNESS_H

#include "analysis/jobs/jobs.h"
#include "analysis/solve/solve_settings.h"
#include "cli/command.h"

/* Computes a harness file and prints or writes its results; returns the exit code. `jobs`: how the
 * runs of bands are computed. */
int wb_solve_harness(const struct wb_command_common *common,
                     const struct wb_solve_settings *settings, const struct wb_jobs_options *jobs);

#endif
