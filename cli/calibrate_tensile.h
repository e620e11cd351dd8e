/* `wirebench calibrate --tensile`: tensile tests of a wire's constituents. */
#ifndef WB_CLI_CALIBRATE_TENSILE_H
#define WB_CLI_CALIBRATE_TENSILE_H

/* Runs the command; returns an exit code. */
int wb_calibrate_tensile(int argc, char **argv);

#endif
