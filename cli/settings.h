/* Options of the command line made from rows of settings (base/setting.h).
 *
 * A command names its tables and an argp with its other options, its parser and its texts; options
 * of rows are parsed here. Where a command has several kinds, `--help` shows the options of one
 * kind, and an option of another kind is rejected with a message that names its kinds.
 */
#ifndef WB_CLI_SETTINGS_H
#define WB_CLI_SETTINGS_H

#include <argp.h>

#include "base/setting.h"

/* Tables whose structs lie in the command's input. */
struct wb_settings_source {
    const struct wb_setting_table *tables;
    size_t n_tables;
    size_t offset;     /* in the input; the tables' offsets count from it */
    unsigned applies;  /* bits of the places of rows that name none; 0: all */
    const char *title; /* of their own part of --help; NULL: they are listed with the others */
};

struct wb_settings_command {
    const struct argp *argp; /* its parser receives the input and all keys other than settings */
    const struct wb_settings_source *sources;
    size_t n_sources;
    unsigned
        place; /* one bit: only its options are accepted and shown; 0: all accepted, none shown */
    /* Names of the places by bit, NULL-terminated, for the messages about options of other places.
     * NULL: options of other places are unknown options. */
    const char *const *places;
    /* Called for each option of a row that was given, with the index of its source; may be NULL. */
    void (*note)(void *input, const struct wb_setting *row, size_t source);
};

/* Parses as wb_command_parse() does. */
void wb_settings_parse(const struct wb_settings_command *command, int argc, char **argv,
                       void *input);

/* The same for a command with one table and one place, 1 if the rows name none; `settings` is the
 * struct of the table, within the input. */
void wb_settings_parse_table(const struct argp *argp, const struct wb_setting_table *table,
                             void *settings, unsigned place, int argc, char **argv, void *input);

/* The first argument that is neither an option nor the value of an option of any place, or NULL. */
const char *wb_settings_first_argument(const struct wb_settings_command *command, int argc,
                                       char **argv);

#endif
