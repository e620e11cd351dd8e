/* `wirebench calibrate` on datasets of three-point bending. */
#ifndef WB_CLI_CALIBRATE_THREE_POINT_H
#define WB_CLI_CALIBRATE_THREE_POINT_H

#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "cli/command.h"
#include "cli/datasets.h"

/* Calibrates, writes the properties if an output was named, prints; returns an exit code. */
int wb_calibrate_three_point(struct wb_three_point_calibrate_settings *settings,
                             const struct wb_datasets *datasets,
                             const struct wb_command_common *common);

/* A callback of a calibration's settings: shows the fits that are done in a wb_progress, the
 * context; false after an interrupt. */
bool wb_calibrate_report(void *context, int done, int all);

#endif
