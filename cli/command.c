#include "cli/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "cli/complete.h"

#define WB_LOG_DOMAIN "command"

const struct argp_option wb_command_help_options[] = {
    {"help", 'h', NULL, 0, "Show this help", -1},
    {"usage", 'U', NULL, 0, "Show a short usage message", -1},
    {0},
};

static error_t parse_help(int key, char *argument, struct argp_state *state)
{
    (void)argument;
    switch (key) {
    case 'h':
        argp_state_help(state, stdout, ARGP_HELP_STD_HELP);
        return 0;
    case 'U':
        argp_state_help(state, stdout, ARGP_HELP_USAGE | ARGP_HELP_EXIT_OK);
        return 0;
    case ARGP_KEY_INIT:
        /* The only child is the command's own parser. */
        state->child_inputs[0] = state->input;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

void wb_command_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    char name[64];
    snprintf(name, sizeof name, "wirebench %s", argv[0]);
    argv[0] = name;
    argp_err_exit_status = WB_EXIT_USAGE;
    /* Suppresses the note about arguments of short options. */
    setenv("ARGP_HELP_FMT", "no-dup-args-note", 0);
    const struct argp_child children[] = {{.argp = argp}, {0}};
    const struct argp with_help = {
        .options = wb_command_help_options,
        .parser = parse_help, /* the child has arguments and text */
        .children = children,
    };
    if (wb_complete_is_on()) {
        wb_complete_finish(&with_help);
        exit(WB_EXIT_OK);
    }
    if (argp_parse(&with_help, argc, argv, ARGP_NO_HELP, NULL, input) != 0)
        exit(WB_EXIT_USAGE);
}

int wb_command_integer(struct argp_state *state, const char *option, const char *text, int minimum,
                       int maximum)
{
    long value = 0;
    if (!wb_number_parse_integer(text, &value) || value < minimum || value > maximum)
        argp_error(state, "%s: expected a whole number from %d to %d, not '%s'", option, minimum,
                   maximum, text);
    return (int)value;
}

static void take_argument(struct argp_state *state, const char *argument,
                          struct wb_command_common *common)
{
    if (common->least == 0 && common->input)
        argp_error(state, "one %s at a time: unexpected argument '%s'", common->noun, argument);
    if (!common->input) {
        /* argp passes the arguments after all options, which it has moved before them. */
        common->inputs = (const char *const *)&state->argv[state->next - 1];
        common->input = argument;
    }
    common->n += common->least > 0;
}

static void check(struct argp_state *state, const struct wb_command_common *common)
{
    if (common->noun && common->least == 0 && !common->input)
        argp_error(state, "name a %s", common->noun);
    if (common->n < common->least)
        argp_error(state, "name %s", common->noun);
    if (common->destination && !common->output)
        argp_error(state, "say where the %s", common->destination);
}

error_t wb_command_parse_field(int key, char *argument, struct argp_state *state)
{
    char *const input = state->input;
    if (key < WB_KEY_TEXTS || key >= WB_KEY_FIELDS_END)
        return ARGP_ERR_UNKNOWN;
    void *const field = input + (key < WB_KEY_FLAGS ? key - WB_KEY_TEXTS : key - WB_KEY_FLAGS);
    if (key < WB_KEY_FLAGS)
        *(const char **)field = argument;
    else
        *(bool *)field = true;
    return 0;
}

error_t wb_command_parse_common(int key, char *argument, struct argp_state *state)
{
    struct wb_command_common *const common = state->input;
    switch (key) {
    case 'o':
        common->output = argument;
        return 0;
    case WB_KEY_FORCE:
        common->force = true;
        return 0;
    case WB_KEY_JSON:
        common->json = true;
        return 0;
    case WB_KEY_NO_FIGURE:
        common->no_figure = true;
        return 0;
    case WB_KEY_IGNORED:
        return 0;
    case ARGP_KEY_ARG:
        if (!common->noun)
            return ARGP_ERR_UNKNOWN;
        take_argument(state, argument, common);
        return 0;
    case ARGP_KEY_END:
        check(state, common);
        return 0;
    default:
        return wb_command_parse_field(key, argument, state);
    }
}

const char *wb_command_find(const char *name, char path[WB_PATH])
{
    if (wb_file_exists(name) || wb_file_find_data(path, name) != WB_OK)
        return name;
    return path;
}

enum wb_status wb_command_check_output(const char *path, bool force)
{
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists; --force overwrites it", path);
    return WB_OK;
}

bool wb_command_ends_in(const char *name, const char *ending)
{
    const size_t n = strlen(name), m = strlen(ending);
    return n > m && strcmp(name + n - m, ending) == 0;
}

int wb_command_exit(enum wb_status status)
{
    return status == WB_OK ? WB_EXIT_OK : WB_EXIT_FAILED;
}

void wb_command_print_json(struct wb_json *root)
{
    char *const text = wb_json_format(root);
    fputs(text, stdout);
    free(text);
    wb_json_destroy(root);
}
