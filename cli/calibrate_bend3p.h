/* `wirebench calibrate` on datasets of three-point bending. */
#ifndef WB_CLI_CALIBRATE_BEND3P_H
#define WB_CLI_CALIBRATE_BEND3P_H

#include "analysis/calibration/bend3p_calibrate.h"
#include "cli/command.h"
#include "cli/datasets.h"

/* Calibrates, writes the properties if an output was named, prints; returns an exit code. */
int wb_calibrate_bend3p(struct wb_bend3p_calibrate_settings *settings,
                        const struct wb_datasets *datasets, const struct wb_command_common *common);

#endif
