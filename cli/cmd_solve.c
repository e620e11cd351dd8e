/* wirebench solve: a simulated test. The kinds of models, and their options. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/text.h"
#include "cli/settings.h"
#include "cli/solve.h"

struct kind {
    const char *name;
    int (*run)(const struct wb_solve_options *options);
    const char *arguments, *summary;
};

/* In the order of the kinds' bits. */
static const struct kind kinds[] = {
    {"cantilever", wb_solve_cantilever, "cantilever --wire=NAME --length-mm=L --deflection-mm=D",
     "Computes a bending test with the 1D beam model of a homogenised wire, described by options."},
    {"wire3d", wb_solve_wire, "wire3d MODEL.yaml",
     "Computes a model file (fixtures/models, by name or path) as a 3D solid."},
    {"wire1d", wb_solve_wire, "wire1d MODEL.yaml",
     "Computes a model file (fixtures/models, by name or path) as a rod of fibres."},
    {"bundle", wb_solve_bundle, "bundle BUNDLE.yaml",
     "Computes a bundle file (fixtures/bundles, by name or path), wires with contact and tape, in "
     "explicit dynamics."},
};

enum {
    KINDS = sizeof kinds / sizeof kinds[0]
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_solve_settings, .n_tables = 1},
    {.tables = wb_bundle_override_tables,
     .n_tables = WB_BUNDLE_OVERRIDE_TABLES,
     .offset = offsetof(struct wb_solve_options, override),
     .applies = WB_SOLVE_BUNDLE},
};

static const struct argp_option other_options[] = {
    {"output", 'o', "DATASET", 0, "Write a dataset folder", 0},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the dataset, and the files of --vtk", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object instead of CSV", 0},
    {0},
};

static const struct kind *find_kind(const char *name)
{
    for (int i = 0; i < KINDS; i++)
        if (strcmp(kinds[i].name, name) == 0)
            return &kinds[i];
    return NULL;
}

static void take_argument(struct argp_state *state, const char *argument,
                          struct wb_solve_options *o)
{
    const bool takes_model = o->kind != 0 && o->kind != WB_SOLVE_CANTILEVER;
    if (takes_model && !o->model) {
        o->model = argument;
        return;
    }
    if (o->kind != 0)
        argp_error(state, "one model at a time, not '%s' too", argument);
    const struct kind *const kind = find_kind(argument);
    if (!kind) {
        argp_error(state, "no model '%s'; there are cantilever, wire3d, wire1d, bundle", argument);
        return;
    }
    o->kind = 1U << (kind - kinds);
    o->kind_name = kind->name;
}

static void check(struct argp_state *state, const struct wb_solve_options *o)
{
    if (o->kind == 0)
        argp_error(state, "name the model: cantilever, wire3d, wire1d or bundle");
    if (o->vtk_every > 0 && !o->vtk)
        argp_error(state, "--vtk-every is for --vtk");
    if (o->kind != WB_SOLVE_CANTILEVER && !o->model)
        argp_error(state, "name the model file: %s MODEL.yaml", o->kind_name);
    if (o->kind == WB_SOLVE_CANTILEVER && (!o->wire || o->length == 0.0 || o->deflection == 0.0))
        argp_error(state, "--wire, --length-mm and --deflection-mm are needed");
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_solve_options *o = state->input;

    switch (key) {
    case ARGP_KEY_ARG:
        take_argument(state, argument, o);
        return 0;
    case ARGP_KEY_END:
        check(state, o);
        return 0;
    default:
        return wb_command_parse_common(key, argument, state, &o->common);
    }
}

/* What --help says before and after the options. */
static void describe(const struct kind *kind, struct wb_text *arguments, struct wb_text *text)
{
    for (int i = 0; i < KINDS; i++) {
        if (kind && kind != &kinds[i])
            continue;
        wb_text_append(arguments, "%s%s", arguments->length > 0 ? "\n" : "", kinds[i].arguments);
        if (kind)
            wb_text_append(text, "%s ", kinds[i].summary);
        else
            wb_text_append(text, "%s: %s\n", kinds[i].name, kinds[i].summary);
    }
    wb_text_append(text, "The curve is printed as CSV or JSON, or written as a dataset.");
    if (!kind)
        wb_text_append(
            text,
            " Each kind has options of its own, which for example `wirebench solve bundle --help` "
            "shows.");
    wb_text_append(text, "\vExit code 3: the curve was cut short because the solver did not "
                         "converge, or by Ctrl-C; what was computed is there.");
}

static void parse_options(int argc, char **argv, struct wb_solve_options *options)
{
    const char *names[KINDS + 1] = {NULL};
    struct wb_text arguments = {0}, text = {0};
    struct argp argp = {.options = other_options, .parser = parse};
    struct wb_settings_command command = {
        .argp = &argp,
        .sources = sources,
        .n_sources = WB_COUNT(sources),
        .places = names,
    };
    for (int i = 0; i < KINDS; i++)
        names[i] = kinds[i].name;
    /* Options may stand before the kind that they are of. */
    const char *const first = wb_settings_first_argument(&command, argc, argv);
    const struct kind *const kind = first ? find_kind(first) : NULL;
    describe(kind, &arguments, &text);
    argp.args_doc = wb_text_string(&arguments);
    argp.doc = wb_text_string(&text);
    command.place = kind ? 1U << (kind - kinds) : 0;
    wb_settings_parse(&command, argc, argv, options);
    wb_text_release(&arguments);
    wb_text_release(&text);
}

int wb_cmd_solve(int argc, char **argv)
{
    struct wb_solve_options options = {0};
    wb_setting_fill(&wb_solve_settings, &options);
    parse_options(argc, argv, &options);
    wb_interrupt_install();
    return find_kind(options.kind_name)->run(&options);
}
