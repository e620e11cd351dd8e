/* The subcommands of `wirebench import`, each in a file of its own. argv[0] is the subcommand's
 * name; returns an exit code. */
#ifndef WB_CLI_IMPORT_H
#define WB_CLI_IMPORT_H

int wb_import_force(int argc, char **argv);
int wb_import_mocap(int argc, char **argv);

#endif
