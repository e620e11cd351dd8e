/* The calibrations of `wirebench calibrate` that an option selects, each in a file of its own:
 * --tensile, --compliance, --constituents. argv[0] is the command's name; returns an exit code. */
#ifndef WB_CLI_CALIBRATE_H
#define WB_CLI_CALIBRATE_H

int wb_calibrate_tensile(int argc, char **argv);
int wb_calibrate_compliance(int argc, char **argv);
int wb_calibrate_constituents(int argc, char **argv);

#endif
