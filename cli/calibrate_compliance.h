/* `wirebench calibrate --compliance`: compliance of a machine, from tests of a stiff bar. */
#ifndef WB_CLI_CALIBRATE_COMPLIANCE_H
#define WB_CLI_CALIBRATE_COMPLIANCE_H

/* Runs the command; returns an exit code. */
int wb_calibrate_compliance(int argc, char **argv);

#endif
