/* Options of the command line made from rows of settings (base/setting.h).
 *
 * A command names its tables and, as usual, an argp with its other options, its parser and its
 * texts; the rows' options come first and are read here. Where one command has several kinds,
 * `--help` shows the options of one kind, and an option of another is refused by the kinds' names.
 */
#ifndef WB_CLI_SETTINGS_H
#define WB_CLI_SETTINGS_H

#include <argp.h>

#include "base/setting.h"

/* Tables whose structs lie in the command's input. */
struct wb_settings_source {
    const struct wb_setting_table *tables;
    size_t n_tables;
    size_t offset;     /* in the input, of what the tables' offsets count from */
    unsigned applies;  /* bits of the places of rows that name none; 0: all */
    const char *title; /* of their own part of --help; NULL: they stand among all others */
};

struct wb_settings_command {
    const struct argp *argp; /* its parser gets the input, and all keys that are not of settings */
    const struct wb_settings_source *sources;
    size_t n_sources;
    unsigned
        place; /* one bit: only its options are taken and shown; 0: all are taken, none shown */
    /* Names of the places by bit, NULL-terminated: options of another one are refused by their
     * names. NULL: they are unknown. */
    const char *const *places;
    /* Is told of each option of a row that was given; NULL: nobody is. */
    void (*note)(void *input, const struct wb_setting *row);
};

/* Parses as wb_command_parse() does. */
void wb_settings_parse(const struct wb_settings_command *command, int argc, char **argv,
                       void *input);

/* The same of a command with one table and one place, 1 where the rows name none; `settings` are
 * the table's, within the input. */
void wb_settings_parse_table(const struct argp *argp, const struct wb_setting_table *table,
                             void *settings, unsigned place, int argc, char **argv, void *input);

/* The first argument that is neither an option nor an option's value, whatever place the options
 * are of; NULL when there is none. */
const char *wb_settings_first_argument(const struct wb_settings_command *command, int argc,
                                       char **argv);

#endif
