/* Shared by all commands: exit codes, option parsing, declarations for the table.
 *
 * To add a command, write cli/cmd_NAME.c with its argp options and `int wb_cmd_NAME(int, char **)`
 * (usage, option table, parse, call the library, print; no numerics), declare it below, add it to
 * the table in main.c and to cli/meson.build, and write its section in docs/commands.md, from which
 * its manual page is made.
 */
#ifndef WB_CLI_COMMAND_H
#define WB_CLI_COMMAND_H

#include <argp.h>
#include <stdbool.h>

#include "base/file.h"
#include "base/json.h"
#include "base/setting.h"
#include "base/status.h"

enum {
    WB_EXIT_OK = 0,
    WB_EXIT_FAILED = 1,
    WB_EXIT_USAGE = 2,
    WB_EXIT_INCOMPLETE = 3, /* usable but incomplete: data lost, stopped by a limit or Ctrl-C, no
                               convergence */
    WB_EXIT_LIMIT = 4       /* complete, with a negative result: a limit of the campaign is
                               exceeded, the bench is not ready, batches differ */
};

/* -h, --help and --usage of every command. */
extern const struct argp_option wb_command_help_options[];

/* Parses the options of a command. argv[0] is its name; -h, --help and --usage are added. Exits
 * with WB_EXIT_USAGE on wrong usage, as argp does. */
void wb_command_parse(const struct argp *argp, int argc, char **argv, void *input);

/* For an argp parser: reads the argument of an option as a whole number within [minimum, maximum],
 * or exits with a usage error that names the option. */
int wb_command_integer(struct argp_state *state, const char *option, const char *text, int minimum,
                       int maximum);

/* Options of most commands: one argument or several, an output, --force and --json. */
struct wb_command_common {
    const char *noun;        /* of the argument, for messages: "recording"; of several arguments
                                "at least one dataset"; NULL: the command parses them itself */
    const char *destination; /* of -o, for messages: "figures go: -o DIR"; NULL: -o is optional, or
                                not an option of the command */
    int least;               /* smallest number of several arguments; 0: exactly one */
    const char *input;       /* the argument, or the first */
    const char *const *inputs; /* (n) of several; borrowed from argv */
    int n;
    const char *output;
    bool force, json;
    bool no_figure; /* for a command that draws a figure beside its output */
};

enum {
    WB_KEY_FORCE = 1000,
    WB_KEY_JSON,
    WB_KEY_NO_FIGURE,
    WB_KEY_IGNORED, /* an option that was looked for before the others, and selected them */
    WB_KEY_OWN,     /* the first key for options of a command's own */
    WB_KEY_TEXTS = 1 << 20,
    WB_KEY_FLAGS = 1 << 21,
    WB_KEY_FIELDS_END = 1 << 22
};

/* The key of an option that stores its argument in a `const char *` of the parser's input, and of
 * one that sets a bool in it: WB_KEY_TEXT(options, figure). A field of another type does not
 * compile. */
#define WB_KEY_TEXT(struct_, field_)                                                               \
    (WB_KEY_TEXTS + (int)WB_ROW_OFFSET(struct_, field_, const char * : 1))
#define WB_KEY_FLAG(struct_, field_) (WB_KEY_FLAGS + (int)WB_ROW_OFFSET(struct_, field_, bool : 1))

/* Sets the field of an option of WB_KEY_TEXT() or WB_KEY_FLAG(); ARGP_ERR_UNKNOWN for other keys.
 */
error_t wb_command_parse_field(int key, char *argument, struct argp_state *state);

/* The parser of a command, or the default branch of its own parser: handles 'o', the keys above
 * WB_KEY_OWN, the fields and the arguments, and checks at the end that argument and output were
 * given. The parser's input begins with a struct wb_command_common. */
error_t wb_command_parse_common(int key, char *argument, struct argp_state *state);

/* Finds a file by its name: in the current folder, else among the shipped files, so that
 * "fixtures/rigs/paper.yaml" works from any folder. Returns `path` or, if neither exists, `name`.
 */
const char *wb_command_find(const char *name, char path[WB_PATH]);

/* Fails with WB_ERR_EXISTS where a file exists and may not be replaced. */
WB_MUST_CHECK enum wb_status wb_command_check_output(const char *path, bool force);

/* Whether a file's name is longer than this ending and ends in it. */
bool wb_command_ends_in(const char *name, const char *ending);

/* WB_EXIT_OK or, for a failed library call whose message was logged, WB_EXIT_FAILED. */
int wb_command_exit(enum wb_status status);

/* Prints the document on stdout and destroys it. Ends the process with WB_EXIT_FAILED if memory ran
 * out, with a message. */
void wb_command_print_json(struct wb_json *root);

int wb_cmd_align(int argc, char **argv);
int wb_cmd_calibrate(int argc, char **argv);
int wb_cmd_clock(int argc, char **argv);
int wb_cmd_compare(int argc, char **argv);
int wb_cmd_doctor(int argc, char **argv);
int wb_cmd_export(int argc, char **argv);
int wb_cmd_import(int argc, char **argv);
int wb_cmd_info(int argc, char **argv);
int wb_cmd_quicklook(int argc, char **argv);
int wb_cmd_record(int argc, char **argv);
int wb_cmd_recover(int argc, char **argv);
int wb_cmd_replay(int argc, char **argv);
int wb_cmd_report(int argc, char **argv);
int wb_cmd_rig(int argc, char **argv);
int wb_cmd_solve(int argc, char **argv);
int wb_cmd_stage(int argc, char **argv);
int wb_cmd_validate(int argc, char **argv);
int wb_cmd_verify(int argc, char **argv);

#endif
