/* `wirebench calibrate --constituents`: a wire from its conductor and its jacket. */
#ifndef WB_CLI_CALIBRATE_CONSTITUENTS_H
#define WB_CLI_CALIBRATE_CONSTITUENTS_H

#include <stdbool.h>

/* Whether --constituents is among the arguments. */
bool wb_calibrate_is_constituents(int argc, char **argv);

/* Runs the command; returns an exit code. */
int wb_calibrate_constituents(int argc, char **argv);

#endif
