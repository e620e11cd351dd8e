/* `wirebench info` of files other than recordings. */
#ifndef WB_CLI_INFO_H
#define WB_CLI_INFO_H

#include "analysis/schema/schema.h"
#include "cli/command.h"
#include "cli/file_kind.h"

struct wb_info_options {
    struct wb_command_common common;
    /* For bundles. */
    const char *figure;                      /* path of a drawing of the section, or NULL */
    const char *mesh;                        /* name of the mesh to draw; NULL: that of the run */
    const struct wb_schema_document *schema; /* to be printed in place of a file; NULL: none */
};

/* Each prints one file and returns an exit code. */
int wb_info_bundle(const struct wb_info_options *options); /* also of a shipped one, by its name */
int wb_info_file(const struct wb_info_options *options, enum wb_file_kind kind);

#endif
