/* `wirebench stage RIG.yaml check`: compares the load cell with one known mass or a series. */
#ifndef WB_CLI_CHECK_CELL_H
#define WB_CLI_CHECK_CELL_H

#include "cli/bench_options.h"
#include "daq/protocol/rig.h"

/* Asks for the masses, prints and logs the result, writes the certificate. Returns an exit code,
 * WB_EXIT_FAILED also if the check did not pass. */
int wb_check_cell_run(const struct wb_stage_options *options, const struct wb_rig *rig);

#endif
