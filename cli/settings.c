#include "cli/settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/command.h"
#include "cli/complete.h"

enum {
    FIRST_KEY = 10000 /* beyond the keys of commands */
};

/* One row as an option. */
struct entry {
    const struct wb_setting *row;
    const struct wb_settings_source *source;
    size_t offset;    /* of the row's struct in the input */
    unsigned applies; /* bits of places; 0: all */
    char *help;       /* owned */
};

/* State of the parser. */
struct line {
    const struct wb_settings_command *command;
    void *input;
    size_t n;
    struct entry *entries;       /* (n) */
    struct argp_option *options; /* the command's own, then those of the entries */
    const char *first;           /* argument */
};

static bool is_taken(const struct line *line, const struct entry *entry)
{
    const unsigned place = line->command->place;
    return place == 0 || entry->applies == 0 || (entry->applies & place) != 0;
}

/* Group of a source in --help. */
static int group_of(const struct line *line, const struct wb_settings_source *source)
{
    return source->title ? 1 + (int)(source - line->command->sources) : 0;
}

/* Index of the entry of that option, or of a new one. Kinds that share an option have rows of their
 * own: the row of the current place is used for all. */
static size_t find_entry(const struct line *line, const char *option)
{
    size_t i = 0;
    while (i < line->n && strcmp(line->entries[i].row->option, option) != 0)
        i++;
    return i;
}

static void add_entry(struct line *line, const struct wb_settings_source *source,
                      const struct wb_setting_table *table, const struct wb_setting *row)
{
    const size_t i = find_entry(line, row->option);
    struct entry *const entry = &line->entries[i];
    struct wb_text help = {0};
    const struct entry own = {
        .row = row,
        .source = source,
        .offset = source->offset + table->offset,
        .applies = row->applies ? row->applies : source->applies,
        .help = entry->help,
    };
    const unsigned others = i < line->n ? entry->applies : 0;
    const bool is_kept = i < line->n && (is_taken(line, entry) || !is_taken(line, &own));
    if (!is_kept)
        *entry = own;
    entry->applies = own.applies | others;
    if (is_kept)
        return;
    const bool shows = line->command->place != 0 && is_taken(line, entry);
    if (!shows && !line->command->places)
        return;
    wb_setting_describe(row, table->otherwise, &help);
    free(entry->help);
    entry->help = help.bytes;
    line->options[i] = (struct argp_option){
        .name = row->option,
        .key = FIRST_KEY + (int)i,
        .arg = row->type == WB_SETTING_BOOLEAN ? NULL : row->argument,
        .flags = shows ? 0 : OPTION_HIDDEN,
        .doc = help.bytes,
        .group = group_of(line, source),
    };
    if (i == line->n)
        line->n++;
}

static size_t count(const struct wb_settings_command *command)
{
    size_t n = 0;
    for (size_t s = 0; s < command->n_sources; s++)
        for (size_t t = 0; t < command->sources[s].n_tables; t++)
            n += command->sources[s].tables[t].n;
    return n;
}

static void begin(struct line *line, const struct wb_settings_command *command, void *input)
{
    const struct argp_option *const own = command->argp->options;
    const size_t most = count(command);
    size_t n_own = 0;
    while (own[n_own].name)
        n_own++;
    *line = (struct line){
        .command = command,
        .input = input,
        .entries = wb_memory_new(most + 1, sizeof *line->entries),
        .options = wb_memory_new(most + n_own + command->n_sources + 1, sizeof *line->options),
    };
    for (size_t s = 0; s < command->n_sources; s++) {
        const struct wb_settings_source *const source = &command->sources[s];
        for (size_t t = 0; t < source->n_tables; t++)
            for (size_t i = 0; i < source->tables[t].n; i++)
                if (source->tables[t].rows[i].option)
                    add_entry(line, source, &source->tables[t], &source->tables[t].rows[i]);
    }
    /* argp puts an option without a group into that of the option before it. */
    memmove(&line->options[n_own], line->options, line->n * sizeof *line->options);
    memcpy(line->options, own, n_own * sizeof *own);
    struct argp_option *title = &line->options[line->n + n_own];
    for (size_t s = 0; s < command->n_sources; s++) {
        const struct wb_settings_source *const source = &command->sources[s];
        if (source->title)
            *title++ = (struct argp_option){.doc = source->title, .group = group_of(line, source)};
    }
}

static void end(struct line *line)
{
    for (size_t i = 0; i < line->n; i++)
        free(line->entries[i].help);
    free(line->options);
    free(line->entries);
}

/* "wire3d and bundle" */
static void name_places(const struct line *line, unsigned applies, char *text, size_t size)
{
    text[0] = '\0';
    for (int i = 0; line->command->places[i]; i++) {
        const size_t used = strlen(text);
        if (applies & 1U << i)
            snprintf(text + used, size - used, "%s%s", used > 0 ? " and " : "",
                     line->command->places[i]);
    }
}

static void reject(const struct line *line, struct argp_state *state, const struct entry *entry)
{
    char own[64], others[128];
    name_places(line, line->command->place, own, sizeof own);
    name_places(line, entry->applies, others, sizeof others);
    argp_error(state, "--%s applies to %s, not to %s", entry->row->option, others, own);
}

static void take(struct line *line, struct argp_state *state, const struct entry *entry,
                 const char *argument)
{
    char problem[WB_SETTING_PROBLEM];
    if (!is_taken(line, entry)) {
        reject(line, state, entry);
        return;
    }
    if (!wb_setting_parse(entry->row, argument, (char *)line->input + entry->offset, problem))
        argp_error(state, "--%s: %s", entry->row->option, problem);
    else if (line->command->note)
        line->command->note(line->input, entry->row,
                            (size_t)(entry->source - line->command->sources));
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct line *const line = state->input;
    if (key >= FIRST_KEY && key < FIRST_KEY + (int)line->n) {
        take(line, state, &line->entries[key - FIRST_KEY], argument);
        return 0;
    }
    state->input = line->input;
    const error_t status = line->command->argp->parser(key, argument, state);
    state->input = line;
    return status;
}

static void offer_choices(const struct wb_setting *row)
{
    for (const char *const *choice = row->choices; choice && *choice; choice++)
        wb_complete_value(row->option, *choice);
}

void wb_settings_parse(const struct wb_settings_command *command, int argc, char **argv,
                       void *input)
{
    struct line line;
    struct argp argp = *command->argp;
    begin(&line, command, input);
    for (size_t i = 0; i < line.n; i++)
        offer_choices(line.entries[i].row);
    argp.options = line.options;
    argp.parser = parse;
    wb_command_parse(&argp, argc, argv, &line);
    end(&line);
}

void wb_settings_parse_table(const struct argp *argp, const struct wb_setting_table *table,
                             void *settings, unsigned place, int argc, char **argv, void *input)
{
    const struct wb_settings_source source = {
        .tables = table, .n_tables = 1, .offset = (size_t)((char *)settings - (char *)input)};
    const struct wb_settings_command command = {
        .argp = argp, .sources = &source, .n_sources = 1, .place = place};
    wb_settings_parse(&command, argc, argv, input);
}

static error_t keep_first(int key, char *argument, struct argp_state *state)
{
    struct line *const line = state->input;
    if (key == ARGP_KEY_INIT)
        state->child_inputs[0] = line;
    else if (key == ARGP_KEY_ARG && !line->first)
        line->first = argument;
    return 0;
}

static error_t skip(int key, char *argument, struct argp_state *state)
{
    (void)argument, (void)state;
    return key == ARGP_KEY_ARG ? ARGP_ERR_UNKNOWN : 0;
}

const char *wb_settings_first_argument(const struct wb_settings_command *command, int argc,
                                       char **argv)
{
    struct line line;
    begin(&line, command, NULL);
    const struct argp rows = {.options = line.options, .parser = skip};
    /* Options of the command's child, if it has one. */
    const struct argp_child *const child = command->argp->children;
    const struct argp others = {.options = child ? child->argp->options : NULL, .parser = skip};
    const struct argp_child children[] = {{.argp = &rows}, {.argp = child ? &others : NULL}, {0}};
    const struct argp argp = {
        .options = wb_command_help_options, .parser = keep_first, .children = children};
    /* Mistakes are reported when the options of the kind are parsed. */
    (void)argp_parse(&argp, argc, argv, ARGP_SILENT, NULL, &line);
    end(&line);
    return line.first;
}
