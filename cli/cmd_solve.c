/* wirebench solve: a simulated test. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "analysis/simulated.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/number.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/command.h"
#include "fe/history.h"
#include "fe/wire.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 7,
    DEFAULT_POINTS = 53
};

struct options {
    struct wb_command_common common;
    const char *model;                 /* "cantilever" */
    const char *wire;                  /* name or file */
    double length, deflection, strand; /* m */
    int cycles, points;
    bool elastic, weight;
};

/* Everything a run needs and gives. */
struct run {
    const struct options *options;
    struct wb_wire wire;
    struct wb_material material;
    struct wb_section section;
    struct wb_cantilever *cantilever;
    struct wb_history history;
    struct wb_progress progress;
    double done; /* rows */
    double marker[MARKERS];
    double wall, cpu; /* s */
};

enum {
    KEY_WIRE = WB_KEY_OWN,
    KEY_LENGTH,
    KEY_DEFLECTION,
    KEY_LAW,
    KEY_STRAND,
    KEY_WEIGHT,
    KEY_CYCLES,
    KEY_POINTS
};

static const struct argp_option option_table[] = {
    {"wire", KEY_WIRE, "NAME|FILE", 0, "Wire with its properties (fixtures/wires or a file)", 0},
    {"length-mm", KEY_LENGTH, "L", 0, "Free length from clamp to tip", 0},
    {"deflection-mm", KEY_DEFLECTION, "D", 0, "Largest deflection of the tip", 0},
    {"law", KEY_LAW, "LAW", 0, "elastic, or elastoplastic (default)", 0},
    {"strand-mm", KEY_STRAND, "S", 0,
     "Strand that raises the tip, kept straight above the straight wire's tip; without it the "
     "force is vertical and may push",
     0},
    {"weight", KEY_WEIGHT, NULL, 0, "Let the wire's weight act, against the deflection", 0},
    {"cycles", KEY_CYCLES, "N", 0, "Load and unload N times; without it, load once", 0},
    {"points", KEY_POINTS, "N", 0, "N equal steps to the largest deflection (53)", 0},
    {"output", 'o', "DATASET", 0, "Write a dataset folder", 0},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the dataset", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object instead of CSV", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *o = state->input;

    switch (key) {
    case KEY_WIRE:
        o->wire = argument;
        return 0;
    case KEY_LENGTH:
        o->length = WB_MM * wb_command_number(state, "--length-mm", argument, 1e-3, 1e6);
        return 0;
    case KEY_DEFLECTION:
        o->deflection = WB_MM * wb_command_number(state, "--deflection-mm", argument, 1e-6, 1e6);
        return 0;
    case KEY_LAW:
        o->elastic = strcmp(argument, "elastic") == 0;
        if (!o->elastic && strcmp(argument, "elastoplastic") != 0)
            argp_error(state, "--law: expected elastic or elastoplastic, not '%s'", argument);
        return 0;
    case KEY_STRAND:
        o->strand = WB_MM * wb_command_number(state, "--strand-mm", argument, 1e-3, 1e9);
        return 0;
    case KEY_WEIGHT:
        o->weight = true;
        return 0;
    case KEY_CYCLES:
        o->cycles = wb_command_integer(state, "--cycles", argument, 1, 1000);
        return 0;
    case KEY_POINTS:
        o->points = wb_command_integer(state, "--points", argument, 1, 100000);
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 0)
            argp_error(state, "one model at a time, not '%s' too", argument);
        if (strcmp(argument, "cantilever") != 0)
            argp_error(state, "no model '%s'; there is cantilever", argument);
        o->model = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->model)
            argp_error(state, "name the model: cantilever");
        if (!o->wire || o->length == 0.0 || o->deflection == 0.0)
            argp_error(state, "--wire, --length-mm and --deflection-mm are needed");
        return 0;
    default:
        return wb_command_parse_common(key, argument, state, &o->common);
    }
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "cantilever",
    .doc = "Computes a cantilever bending test with the 1D beam model and prints its curve as CSV, "
           "or as JSON, or writes it as a dataset.\v"
           "Exit code 3: the curve was cut short because the solver did not converge, or by "
           "Ctrl-C; what was computed is there.",
};

static enum wb_status prepare(struct run *run)
{
    const struct options *o = run->options;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "wires", o->wire, NULL));
    WB_TRY(wb_wire_read(path, &run->wire));
    if (!run->wire.has_properties)
        return wb_fail(WB_ERR_DATA, "%s: the wire has no `properties` to compute with", path);
    run->material = run->wire.material;
    if (o->elastic)
        run->material.hardening = WB_HARDENING_NONE_ELASTIC;

    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    WB_TRY(wb_section_init_circle(&run->section, run->wire.outer_diameter, &run->material, 0));
    model.section = &run->section;
    model.length = o->length;
    model.strand_length = o->strand;
    model.mass_per_length = o->weight ? wb_wire_mass_per_length(&run->wire) : 0.0;
    for (int i = 0; i < MARKERS; i++)
        run->marker[i] = o->length * i / (MARKERS - 1);
    return wb_cantilever_create(&run->cantilever, &model, NULL);
}

/* Called before every row. */
static bool report_progress(void *context)
{
    struct run *run = context;
    wb_progress_update(&run->progress, run->done++, NULL);
    return wb_interrupted();
}

static double seconds(clockid_t clock)
{
    struct timespec now = {0};
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static enum wb_status compute(struct run *run)
{
    const struct wb_history_plan plan = {
        .control = WB_CONTROL_DEFLECTION,
        .maximum = run->options->deflection,
        .steps = run->options->points,
        .cycles = run->options->cycles,
        .n_shape = MARKERS,
        .shape_s = run->marker,
        .stop = report_progress,
        .stop_context = run,
    };
    WB_TRY(wb_history_init(&run->history, &plan));

    const double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    wb_progress_start(&run->progress, "solve", "rows", wb_history_planned_rows(&plan));
    const enum wb_status status = wb_history_run(&run->history, &plan, run->cantilever);
    wb_progress_finish(&run->progress);
    run->wall = seconds(CLOCK_MONOTONIC) - wall;
    run->cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    return status;
}

static enum wb_status write_dataset(const struct run *run)
{
    const struct options *o = run->options;
    struct wb_test_info info = {
        .length = o->length,
        .outer_diameter = run->wire.outer_diameter,
        .mass_per_length = wb_wire_mass_per_length(&run->wire),
        .poissons_ratio = run->material.poissons_ratio,
        .strand_length = o->strand,
        .gravity = o->weight ? WB_STANDARD_GRAVITY : 0.0,
        .rest_level = (double)NAN,
        .is_simulation = true,
    };
    const struct wb_simulated_origin origin = {
        .model = o->model,
        .law = o->elastic ? "elastic" : "elastoplastic",
        .source = run->wire.source,
        .material = &run->material,
        .wall = run->wall,
        .cpu = run->cpu,
    };
    struct wb_dataset dataset;

    snprintf(info.wire, sizeof info.wire, "%s", run->wire.name);
    WB_TRY(wb_dataset_init(&dataset));
    enum wb_status status = wb_simulated_fill(&dataset, &info, &run->history, run->marker, &origin);
    if (status == WB_OK)
        status = wb_dataset_write(&dataset, o->common.output, o->common.force);
    wb_dataset_release(&dataset);
    return status;
}

static int print_json(const struct run *run)
{
    struct wb_json *root = wb_json_create();
    struct wb_json *points = wb_json_set_array(root, "points");

    for (int i = 0; i < run->history.n_rows; i++) {
        const struct wb_history_row *row = &run->history.rows[i];
        struct wb_json *point = wb_json_append_object(points);
        wb_json_set_integer(point, "cycle", row->cycle);
        wb_json_set_text(point, "phase", wb_history_phase_text(row->phase));
        wb_json_set_number(point, "deflection_mm", row->point.deflection / WB_MM);
        wb_json_set_number(point, "tension_N", row->point.tension);
        wb_json_set_number(point, "force_N", row->force);
        wb_json_set_number(point, "tip_x_mm", row->point.tip_x / WB_MM);
        wb_json_set_number(point, "tip_angle_rad", row->point.tip_angle);
    }
    wb_json_set_boolean(root, "converged", run->history.converged);
    wb_json_set_number(root, "wall_s", run->wall);
    wb_json_set_number(root, "cpu_s", run->cpu);
    return wb_command_print_json(root);
}

static void print_csv(const struct run *run)
{
    puts("cycle,phase,deflection_mm,tension_N,force_N,tip_x_mm,tip_angle_rad");
    for (int i = 0; i < run->history.n_rows; i++) {
        const struct wb_history_row *row = &run->history.rows[i];
        const double column[] = {row->point.deflection / WB_MM, row->point.tension, row->force,
                                 row->point.tip_x / WB_MM, row->point.tip_angle};
        printf("%d,%s", row->cycle, wb_history_phase_text(row->phase));
        for (size_t k = 0; k < sizeof column / sizeof column[0]; k++) {
            char text[WB_NUMBER_TEXT];
            printf(",%s", wb_number_format(column[k], text));
        }
        putchar('\n');
    }
}

static int deliver(const struct run *run)
{
    if (run->options->common.output) {
        const int code = wb_command_exit(write_dataset(run));
        if (code != WB_EXIT_OK)
            return code;
    }
    if (run->options->common.json) {
        const int code = print_json(run);
        if (code != WB_EXIT_OK)
            return code;
    } else if (!run->options->common.output) {
        print_csv(run);
    }
    if (!run->history.converged)
        wb_warn("the solver did not converge beyond a deflection of %.4g mm; the curve ends at "
                "row %d",
                run->history.end.deflection / WB_MM, run->history.n_rows);
    if (run->history.stopped)
        wb_warn("stopped after %d rows", run->history.n_rows);
    return run->history.converged && !run->history.stopped ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_cmd_solve(int argc, char **argv)
{
    struct options options = {.points = DEFAULT_POINTS};
    wb_command_parse(&argp, argc, argv, &options);
    wb_interrupt_install();

    struct run run = {.options = &options};
    enum wb_status status = prepare(&run);
    if (status == WB_OK)
        status = compute(&run);
    const int code = status == WB_OK ? deliver(&run) : wb_command_exit(status);

    wb_history_release(&run.history);
    wb_cantilever_destroy(run.cantilever);
    wb_section_release(&run.section);
    return code;
}
