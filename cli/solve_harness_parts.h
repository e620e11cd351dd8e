/* The runs of `wirebench solve harness --uncertain` in parts: tasks of --solve and --slurm. */
#ifndef WB_CLI_SOLVE_HARNESS_PARTS_H
#define WB_CLI_SOLVE_HARNESS_PARTS_H

#include "analysis/harness/harness_bands.h"
#include "analysis/jobs/jobs.h"
#include "analysis/solve/solve_settings.h"
#include "base/status.h"

/* Computes all runs as jobs, whose outputs and logs are in `OUTPUT.jobs`; complete ones are not
 * computed again. *complete is false where some are left, which was reported. */
WB_MUST_CHECK enum wb_status wb_solve_harness_parts_run(struct wb_harness_bands *bands,
                                                        const struct wb_solve_settings *settings,
                                                        const struct wb_jobs_options *jobs,
                                                        bool *complete);

/* Computes the part of settings->part and writes it into the output folder, which exists. */
WB_MUST_CHECK enum wb_status
wb_solve_harness_parts_compute(struct wb_harness_bands *bands,
                               const struct wb_solve_settings *settings);

/* Reads "K/N". */
WB_MUST_CHECK enum wb_status wb_solve_harness_parts_check(const struct wb_solve_settings *settings);

#endif
