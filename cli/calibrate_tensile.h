/* `wirebench calibrate --tensile`: tensile tests of a wire's constituents. */
#ifndef WB_CLI_CALIBRATE_TENSILE_H
#define WB_CLI_CALIBRATE_TENSILE_H

#include <stdbool.h>

/* Whether --tensile is among the arguments. */
bool wb_calibrate_is_tensile(int argc, char **argv);

/* Runs the command; returns an exit code. */
int wb_calibrate_tensile(int argc, char **argv);

#endif
