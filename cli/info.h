/* What `wirebench info` says of files that are no recordings. */
#ifndef WB_CLI_INFO_H
#define WB_CLI_INFO_H

#include <stdbool.h>

#include "cli/command.h"

struct wb_info_options {
    struct wb_command_common common;
    /* Of a bundle. */
    const char *figure; /* file of its section's drawing; NULL: none */
    const char *mesh;   /* whose lines are drawn; NULL: that of the run */
};

/* Whether a file's name says that it is a bundle's, or is that of no file: then of a shipped one.
 */
bool wb_info_is_bundle(const char *name);

/* Returns an exit code. */
int wb_info_bundle(const struct wb_info_options *options);

#endif
