/* The exports of `wirebench export` besides CSV files, each in a file of its own. */
#ifndef WB_CLI_EXPORT_H
#define WB_CLI_EXPORT_H

#include "cli/command.h"

/* `wirebench export --to KIND`: a wire's law as input of another program. Runs the command; returns
 * an exit code. */
int wb_export_card(int argc, char **argv);

/* Exports all tables of the recording or dataset options->input to one HDF5 file, options->output,
 * and prints a summary; returns an exit code. */
int wb_export_hdf5(const struct wb_command_common *options);

#endif
