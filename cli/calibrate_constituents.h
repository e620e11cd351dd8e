/* `wirebench calibrate --constituents`: a wire from its conductor and its jacket. */
#ifndef WB_CLI_CALIBRATE_CONSTITUENTS_H
#define WB_CLI_CALIBRATE_CONSTITUENTS_H

/* Runs the command; returns an exit code. */
int wb_calibrate_constituents(int argc, char **argv);

#endif
