/* `wirebench export REC|DATASET -o FILE.h5`: all tables of a recording or dataset in one file. */
#ifndef WB_CLI_EXPORT_HDF5_H
#define WB_CLI_EXPORT_HDF5_H

#include <stdbool.h>

#include "cli/command.h"

/* Whether the file name ends in .h5 or .hdf5. */
bool wb_export_hdf5_is(const char *output);

/* Exports options->input to options->output and prints a summary; returns an exit code. */
int wb_export_hdf5(const struct wb_command_common *options);

#endif
