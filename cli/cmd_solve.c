/* wirebench solve: a simulated test. The kinds of models and their options. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "analysis/dataset/dataset.h"
#include "analysis/jobs/jobs.h"
#include "analysis/quicklook.h"
#include "analysis/solve/solve.h"
#include "base/interrupt.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/complete.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/job_options.h"
#include "cli/print.h"
#include "cli/settings.h"
#include "cli/solve_harness.h"

#define WB_LOG_DOMAIN "solve"

struct options {
    struct wb_command_common common;
    struct wb_solve_settings settings; /* kind 0: no model was named */
    struct wb_jobs_options jobs;       /* of the bands of a harness */
    bool has_shown;                    /* this process has printed the result: with mpirun, one */
};

/* For --help, in the order of the bits of the kinds. */
static const struct kind {
    const char *arguments, *summary;
    const char *folder; /* of fixtures/ with the shipped models; NULL: described by options */
} kinds[WB_SOLVE_KINDS] = {
    {"--wire=NAME --length-mm=L --deflection-mm=D",
     "Computes a bending test with the 1D beam model of a homogenised wire, described by options.",
     NULL},
    {"MODEL.yaml", "Computes a model file (fixtures/models, by name or path) as a 3D solid.",
     "models"},
    {"MODEL.yaml", "Computes a model file (fixtures/models, by name or path) as a rod of fibres.",
     "models"},
    {"BUNDLE.yaml",
     "Computes a bundle file (fixtures/bundles, by name or path), wires with contact and tape, in "
     "explicit dynamics.",
     "bundles"},
    {"WIRE.yaml --span-mm=L --deflection-mm=D",
     "Computes a wire (fixtures/wires, by name or path) in three-point bending on round rollers.",
     "wires"},
    {"HARNESS.yaml",
     "Computes a harness file (fixtures/harnesses, by name or path): branches, connectors, clips "
     "and the steps of an assembly.",
     "harnesses"},
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_solve_settings_table,
     .n_tables = 1,
     .offset = offsetof(struct options, settings)},
    {.tables = wb_bundle_override_tables,
     .n_tables = WB_BUNDLE_OVERRIDE_TABLES,
     .offset = offsetof(struct options, settings.override),
     .applies = WB_SOLVE_BUNDLE},
};

static const struct argp_option other_options[] = {
    {"output", 'o', "DATASET", 0,
     "Write a dataset folder, and a figure of force over deflection to DATASET.svg"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the dataset, its figure, and the files of --vtk"},
    {"no-figure", WB_KEY_NO_FIGURE, NULL, 0, "Draw no figure"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object instead of CSV"},
    {0},
};

/* The index of a kind; -1: unknown name. */
static int find_kind(const char *name)
{
    for (int i = 0; name && i < WB_SOLVE_KINDS; i++)
        if (strcmp(wb_solve_settings_kinds[i], name) == 0)
            return i;
    return -1;
}

static void take_argument(struct argp_state *state, const char *argument,
                          struct wb_solve_settings *s)
{
    const bool takes_model = s->kind != 0 && s->kind != WB_SOLVE_CANTILEVER;
    if (takes_model && !s->model) {
        s->model = argument;
        return;
    }
    if (s->kind != 0)
        argp_error(state, "one model at a time: unexpected argument '%s'", argument);
    const int kind = find_kind(argument);
    if (kind < 0) {
        argp_error(state,
                   "unknown model '%s': expected cantilever, wire3d, wire1d, bundle, bending3p or "
                   "harness%s",
                   argument, wb_file_exists(argument) ? ", and then a file" : "");
        return;
    }
    s->kind = 1U << kind;
}

static void check(struct argp_state *state, const struct options *options)
{
    const struct wb_solve_settings *const s = &options->settings;
    if (s->kind == 0)
        argp_error(state,
                   "model missing: cantilever, wire3d, wire1d, bundle, bending3p or harness");
    if (s->vtk_every > 0 && !s->vtk)
        argp_error(state, "--vtk-every needs --vtk");
    if (s->frames > 0 && !s->vtk && !s->gltf && !options->common.output)
        argp_error(state, "--frames needs -o, --vtk or --gltf");
    if (s->gltf && !wb_command_ends_in(s->gltf, ".glb"))
        argp_error(state, "--gltf: '%s' does not end in .glb", s->gltf);
    if (s->sweep && !s->uncertain)
        argp_error(state, "--sweep needs --uncertain");
    if ((wb_jobs_wanted(&options->jobs) || s->part) && !(s->uncertain && options->common.output))
        argp_error(state, "--solve, --slurm and --part need --uncertain and -o");
    if (wb_jobs_wanted(&options->jobs) && s->part)
        argp_error(state, "--solve and --slurm compute all parts: remove --part");
    if (s->follow && s->uncertain)
        argp_error(state, "--follow computes no bands: remove --uncertain");
    if (s->checkpoint_interval > 0.0 && !s->checkpoint)
        argp_error(state, "--checkpoint-minutes needs --checkpoint");
    if (s->kind != WB_SOLVE_CANTILEVER && !s->model)
        argp_error(state, "the file is missing: %s %s", wb_solve_settings_kind(s),
                   kinds[find_kind(wb_solve_settings_kind(s))].arguments);
    if (s->kind == WB_SOLVE_THREE_POINT && (s->span == 0.0 || s->deflection == 0.0))
        argp_error(state, "--span-mm and --deflection-mm are required");
    if (s->kind == WB_SOLVE_CANTILEVER && (!s->wire || s->length == 0.0 || s->deflection == 0.0))
        argp_error(state, "--wire, --length-mm and --deflection-mm are required");
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const o = state->input;
    if (key == ARGP_KEY_INIT && state->child_inputs)
        state->child_inputs[0] = &o->jobs;
    if (key == ARGP_KEY_ARG) {
        take_argument(state, argument, &o->settings);
        return 0;
    }
    if (key == ARGP_KEY_END) {
        check(state, o);
        if (o->settings.follow &&
            (o->common.output || o->settings.vtk || o->settings.gltf || o->common.json))
            argp_error(state,
                       "--follow writes no files: -o, --vtk, --gltf and --json do not apply");
    }
    return wb_command_parse_common(key, argument, state);
}

/* The texts of --help before and after the options, of the kind of index `only` or of all (-1). */
static void describe(int only, struct wb_text *arguments, struct wb_text *text)
{
    for (int i = 0; i < WB_SOLVE_KINDS; i++) {
        if (only >= 0 && only != i)
            continue;
        if (only >= 0) {
            wb_text_append(arguments, "%s", kinds[i].arguments);
            wb_text_append(text, "%s ", kinds[i].summary);
            continue;
        }
        wb_text_append(arguments, "%s%s %s", i > 0 ? "\n" : "", wb_solve_settings_kinds[i],
                       kinds[i].arguments);
        wb_text_append(text, "%s: %s\n", wb_solve_settings_kinds[i], kinds[i].summary);
    }
    wb_text_append(text, "The curve is printed as CSV or JSON, or written as a dataset (-o).");
    if (only < 0)
        wb_text_append(text, " Each kind has options of its own: see, for example, `wirebench "
                             "solve bundle --help`.");
    wb_text_append(text, "\vExit code 3: the curve is incomplete because the solver did not "
                         "converge or Ctrl-C stopped it; the computed part is written.");
}

static void parse_options(int argc, char **argv, struct options *options)
{
    char name[32];
    struct wb_text arguments = {0}, text = {0};
    static const struct argp_child jobs[] = {{&wb_job_options_argp, 0, NULL, 0}, {0}};
    struct argp argp = {.options = other_options, .parser = parse, .children = jobs};
    struct wb_settings_command command = {
        .argp = &argp,
        .sources = sources,
        .n_sources = WB_COUNT(sources),
        .places = wb_solve_settings_kinds,
    };
    /* Options may stand before their kind. */
    const int kind = find_kind(wb_settings_first_argument(&command, argc, argv));
    describe(kind, &arguments, &text);
    argp.args_doc = wb_text_string(&arguments);
    argp.doc = wb_text_string(&text);
    command.place = kind >= 0 ? 1U << kind : 0;
    if (command.place != WB_SOLVE_HARNESS)
        argp.children = NULL;
    if (kind >= 0) {
        /* Messages and --help name "wirebench solve bundle". */
        snprintf(name, sizeof name, "solve %s", wb_solve_settings_kinds[kind]);
        argv[0] = name;
        wb_complete_shipped(kinds[kind].folder);
    } else {
        wb_complete_arguments(wb_solve_settings_kinds);
    }
    wb_settings_parse(&command, argc, argv, options);
    options->settings.output = options->common.output;
    options->settings.force = options->common.force;
    wb_text_release(&arguments);
    wb_text_release(&text);
}

/* --- the curve --- */

/* A column of the curve, besides cycle and phase. */
struct column {
    const char *name;
    double value;
};

enum {
    MOST_COLUMNS = 12
};

/* Returns the number of columns. */
static size_t columns_of(const struct wb_solve_row *row, struct column columns[MOST_COLUMNS])
{
    const struct wb_three_point_bending_point *const p = row->bending;
    if (p) {
        const struct column all[] = {
            {"deflection_mm", p->travel / WB_MM},
            {"force_N", p->force},
            {"nose_mm", p->deflection / WB_MM},
            {"middle_mm", p->middle / WB_MM},
            {"contact_angle_rad", p->contact_angle},
            {"draw_in_mm", p->draw_in / WB_MM},
            {"wrapped_rad", p->wrapped},
            {"friction_N", p->tension},
            {"middle_curvature_1_m", p->middle_curvature},
            {"work_J", p->work},
            {"internal_work_J", p->internal_work},
            {"friction_work_J", p->friction_work},
        };
        memcpy(columns, all, sizeof all);
        return WB_COUNT(all);
    }
    const struct column all[] = {
        {"deflection_mm", row->deflection / WB_MM},
        {"tension_N", row->tension},
        {"force_N", row->force},
        {"tip_x_mm", row->tip_x / WB_MM},
        {"tip_angle_rad", row->tip_angle},
    };
    memcpy(columns, all, sizeof all);
    return WB_COUNT(all);
}

/* The names of the columns first, also those of an empty curve. */
static void print_csv(const struct wb_solve *solve)
{
    struct column columns[MOST_COLUMNS];
    struct wb_solve_row row = {0};
    for (int i = -1; i < wb_solve_count(solve); i++) {
        if (wb_solve_count(solve) > 0)
            wb_solve_row(solve, i < 0 ? 0 : i, &row);
        const size_t n = columns_of(&row, columns);
        if (i < 0)
            printf("cycle,phase");
        else
            printf("%d,%s", row.cycle, wb_trial_phase_name(row.phase));
        for (size_t k = 0; k < n; k++) {
            char text[WB_NUMBER_TEXT];
            printf(",%s", i < 0 ? columns[k].name : wb_number_format(columns[k].value, text));
        }
        putchar('\n');
    }
}

static void print_json(const struct wb_solve *solve)
{
    struct wb_json *const root = wb_json_create();
    struct wb_json *const points = wb_json_set_array(root, "points");
    for (int i = 0; i < wb_solve_count(solve); i++) {
        struct wb_json *const object = wb_json_append_object(points);
        struct wb_solve_row row;
        struct column columns[MOST_COLUMNS];
        wb_solve_row(solve, i, &row);
        const size_t n = columns_of(&row, columns);
        wb_json_set_integer(object, "cycle", row.cycle);
        wb_json_set_text(object, "phase", wb_trial_phase_name(row.phase));
        for (size_t k = 0; k < n; k++)
            wb_json_set_number(object, columns[k].name, columns[k].value);
        if (row.is_spatial)
            wb_json_set_number(object, "tip_z_mm", row.tip_z / WB_MM);
        if (row.step)
            wb_json_set_text(object, "step", row.step);
    }
    wb_solve_describe(solve, root);
    wb_command_print_json(root);
}

static enum wb_status show(void *context, const struct wb_solve *solve)
{
    struct options *const o = context;
    const struct wb_command_common *const common = &o->common;
    o->has_shown = true;
    if (common->json) {
        print_json(solve);
        return WB_OK;
    }
    struct wb_text text = {0};
    if (common->json)
        print_json(solve);
    else if (wb_solve_summarise(solve, &text))
        fputs(wb_text_string(&text), stdout);
    else if (!common->output)
        print_csv(solve);
    wb_text_release(&text);
    return WB_OK;
}

/* --- the last lines --- */

/* Whether a figure is drawn, and its path. */
static const char *figure_path(const struct options *o, char path[WB_PATH])
{
    if (!o->common.output || o->common.no_figure)
        return NULL;
    return wb_finding_folder_figure_path(path, o->common.output);
}

static void append_found(struct wb_text *text, const struct wb_dataset *dataset)
{
    char a[WB_PRINT_NUMBER], b[WB_PRINT_NUMBER];
    double deflection = 0.0, force = 0.0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        deflection = fmax(deflection, fabs(dataset->rows[i].deflection));
        force = fmax(force, fabs(dataset->rows[i].force));
    }
    wb_text_append(text, "%s (%s, %zu rows): largest deflection %s mm, largest force %s mN",
                   dataset->info.wire, wb_finding_source(&dataset->info), dataset->n_rows,
                   wb_print_number(deflection / WB_MM, a), wb_print_number(force / WB_MN, b));
}

/* Reads the dataset that was just written, so that figure and finding show what is on disk. */
static enum wb_status print_finding(const struct options *o, bool is_complete)
{
    const unsigned tests = WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT);
    char path[WB_PATH];
    struct wb_finding finding = {.figure = figure_path(o, path)};
    struct wb_dataset dataset;
    WB_TRY(wb_dataset_read_kinds(&dataset, o->common.output, tests, NULL));
    const enum wb_status status =
        finding.figure ? wb_quicklook_draw(&dataset, finding.figure) : WB_OK;
    if (status == WB_OK && !o->common.json) {
        append_found(&finding.found, &dataset);
        wb_text_append(&finding.trust, "%s; computed, not compared with a measurement",
                       is_complete ? "complete" : "in part: the curve ends early, see the warning");
        if (o->settings.vtk)
            wb_finding_append_command(&finding.next, "open the .pvd file in %s with ParaView",
                                      o->settings.vtk);
        else
            wb_finding_append_command(&finding.next,
                                      "wirebench export %s -o FILE.h5, for other programs",
                                      o->common.output);
        wb_finding_print(&finding);
    }
    wb_dataset_release(&dataset);
    return status;
}

/* A file of another kind than the model's; one that does not exist is left to its reader. */
static enum wb_status check_model(const struct wb_solve_settings *s)
{
    const bool is_wire = s->kind == WB_SOLVE_CANTILEVER || s->kind == WB_SOLVE_THREE_POINT;
    const bool is_bundle = s->kind == WB_SOLVE_BUNDLE;
    const char *const folder = is_wire ? "wires" : is_bundle ? "bundles" : "models";
    const char *const name = s->kind == WB_SOLVE_CANTILEVER ? s->wire : s->model;
    struct wb_reason why = {.text = ""};
    char path[WB_PATH];
    if (wb_file_find_named(path, folder, name, NULL, NULL, &why) != WB_OK)
        return WB_OK;
    return wb_file_kind_check(path,
                              is_wire ? WB_FILE_BIT(WB_FILE_WIRE) | WB_FILE_BIT(WB_FILE_PROPERTIES)
                              : is_bundle ? WB_FILE_BIT(WB_FILE_BUNDLE)
                                          : WB_FILE_BIT(WB_FILE_MODEL));
}

static int solve_harness(struct options *options)
{
    const int code = wb_solve_harness(&options->common, &options->settings, &options->jobs);
    wb_jobs_options_release(&options->jobs);
    return code;
}

int wb_cmd_solve(int argc, char **argv)
{
    struct options options = {0};
    char figure[WB_PATH];
    bool complete;
    wb_setting_fill(&wb_solve_settings_table, &options.settings);
    parse_options(argc, argv, &options);
    wb_interrupt_install();
    if (options.settings.kind == WB_SOLVE_HARNESS)
        return solve_harness(&options);
    if (check_model(&options.settings) != WB_OK)
        return WB_EXIT_FAILED;
    /* In the way of a dataset, the message of wb_solve_run() is the better one. */
    if (figure_path(&options, figure) &&
        wb_file_kind_find(options.common.output) != WB_FILE_DATASET &&
        wb_finding_check_figure(figure, options.common.force) != WB_OK)
        return WB_EXIT_FAILED;
    enum wb_status status = wb_solve_run(&options.settings, show, &options, &complete);
    if (status == WB_ERR_ARGUMENT)
        return WB_EXIT_USAGE; /* for example a mesh that the bundle does not have */
    if (status == WB_OK && options.has_shown && options.common.output)
        status = print_finding(&options, complete);
    if (status != WB_OK)
        return wb_command_exit(status);
    return complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
