/* wirebench solve: a simulated test. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/interrupt.h"
#include "base/number.h"
#include "base/units.h"
#include "cli/solve.h"

enum {
    DEFAULT_POINTS = 53
};

enum {
    KEY_WIRE = WB_KEY_OWN,
    KEY_LENGTH,
    KEY_DEFLECTION,
    KEY_LAW,
    KEY_STRAND,
    KEY_WEIGHT,
    KEY_CYCLES,
    KEY_POINTS,
    KEY_VTK,
    KEY_MESH,
    KEY_DEAD_FORCE,
    KEY_NO_WEIGHT,
    KEY_DURATION,
    KEY_MASS_SCALING,
    KEY_SELECTIVE,
    KEY_FRICTION,
    KEY_COHESIVE_STIFFNESS,
    KEY_VTK_EVERY,
    KEY_THREADS,
    KEY_CHECKPOINT,
    KEY_CHECKPOINT_MINUTES
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
    {"vtk", KEY_VTK, "DIR", 0, "Write every row's stress field for ParaView (wire3d, bundle)", 0},
    {"mesh", KEY_MESH, "NAME", 0, "Mesh of a bundle (its file's)", 0},
    {"dead-force", KEY_DEAD_FORCE, NULL, 0, "Raise a bundle by a vertical force, not by its strand",
     0},
    {"no-weight", KEY_NO_WEIGHT, NULL, 0, "Leave a bundle's weight out", 0},
    {"duration-s", KEY_DURATION, "T", 0,
     "Duration of a bundle's loading; otherwise its file's, or chosen so that kinetic energy stays "
     "small",
     0},
    {"mass-scaling", KEY_MASS_SCALING, "F", 0, "Factor on a bundle's masses (its file's)", 0},
    {"selective", KEY_SELECTIVE, "B", 0, "Selective mass scaling of its sections (its file's)", 0},
    {"threads", KEY_THREADS, "N", 0,
     "Compute a bundle in N parts along its axis, on as many cores (1); with mpirun, of each rank",
     0},
    {"checkpoint", KEY_CHECKPOINT, "FILE", 0,
     "Keep a bundle's run in this file every so often; a run that was ended goes on from it when "
     "the same command is given again",
     0},
    {"checkpoint-minutes", KEY_CHECKPOINT_MINUTES, "M", 0, "Time between checkpoints (10)", 0},
    {"friction", KEY_FRICTION, "S[,K,D]", 0,
     "Friction in a bundle: constant, or static, kinetic and decay in s/mm (its file's)", 0},
    {"cohesive-stiffness", KEY_COHESIVE_STIFFNESS, "K", 0,
     "Normal stiffness between tape and wires in N/mm3; the shear stiffness keeps its ratio (its "
     "file's)",
     0},
    {"vtk-every", KEY_VTK_EVERY, "N", 0, "Of a bundle, write every Nth row only, and the last", 0},
    {"output", 'o', "DATASET", 0, "Write a dataset folder", 0},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the dataset, and the files of --vtk", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object instead of CSV", 0},
    {0},
};

/* The long name of an option of the table. */
static const char *option_name(int key)
{
    for (const struct argp_option *option = option_table; option->name; option++)
        if (option->key == key)
            return option->name;
    return "";
}

static const char *const kind_names[] = {
    [WB_SOLVE_NONE] = "",         [WB_SOLVE_CANTILEVER] = "cantilever",
    [WB_SOLVE_WIRE3D] = "wire3d", [WB_SOLVE_WIRE1D] = "wire1d",
    [WB_SOLVE_BUNDLE] = "bundle",
};

static void take_argument(struct argp_state *state, const char *argument,
                          struct wb_solve_options *o)
{
    const bool takes_model = o->kind != WB_SOLVE_NONE && o->kind != WB_SOLVE_CANTILEVER;
    if (takes_model && !o->model) {
        o->model = argument;
        return;
    }
    if (o->kind != WB_SOLVE_NONE)
        argp_error(state, "one model at a time, not '%s' too", argument);
    for (int kind = WB_SOLVE_CANTILEVER; kind <= WB_SOLVE_BUNDLE; kind++)
        if (strcmp(argument, kind_names[kind]) == 0)
            o->kind = (enum wb_solve_kind)kind;
    if (o->kind == WB_SOLVE_NONE)
        argp_error(state, "no model '%s'; there are cantilever, wire3d, wire1d, bundle", argument);
    o->kind_name = kind_names[o->kind];
}

static void check(struct argp_state *state, const struct wb_solve_options *o)
{
    if (o->kind == WB_SOLVE_NONE)
        argp_error(state, "name the model: cantilever, wire3d, wire1d or bundle");
    if (o->vtk && o->kind != WB_SOLVE_WIRE3D && o->kind != WB_SOLVE_BUNDLE)
        argp_error(state, "--vtk: %s has no stress field for ParaView", o->kind_name);
    if (o->vtk_every > 0 && !o->vtk)
        argp_error(state, "--vtk-every is for --vtk");
    if (o->bundle_option && o->kind != WB_SOLVE_BUNDLE)
        argp_error(state, "--%s is for bundle, not for %s", o->bundle_option, o->kind_name);
    if (o->kind == WB_SOLVE_CANTILEVER) {
        if (!o->wire || o->length == 0.0 || o->deflection == 0.0)
            argp_error(state, "--wire, --length-mm and --deflection-mm are needed");
        return;
    }
    if (!o->model)
        argp_error(state, "name the model file: %s MODEL.yaml", o->kind_name);
    if (o->cantilever_option)
        argp_error(state, "--%s is for cantilever; %s has it in its model file",
                   o->cantilever_option, o->kind_name);
}

/* "S" or "S,K,D". */
static void take_friction(struct argp_state *state, const char *argument,
                          struct wb_bundle_override *override)
{
    static const double range[3][2] = {{0.0, 10.0}, {0.0, 10.0}, {1e-9, 1e9}};
    char text[3 * WB_NUMBER_TEXT];
    double value[3] = {0.0};
    int n = 0;

    snprintf(text, sizeof text, "%s", argument);
    for (char *part = text, *next; part; part = next) {
        next = strchr(part, ',');
        if (next)
            *next++ = '\0';
        if (n < 3)
            value[n] = wb_command_number(state, "--friction", part, range[n][0], range[n][1]);
        n++;
    }
    if (n != 1 && n != 3)
        argp_error(state, "--friction: expected S or S,K,D, not '%s'", argument);
    if (n == 1)
        value[1] = value[0];
    if (value[1] > value[0])
        argp_error(state, "--friction: the kinetic coefficient %g is more than the static one, %g",
                   value[1], value[0]);
    override->has_friction = true;
    override->friction_static = value[0];
    override->friction_kinetic = value[1];
    override->friction_decay = value[2] * WB_S_PER_MM;
}

static error_t take_bundle_option(int key, char *argument, struct argp_state *state,
                                  struct wb_solve_options *options)
{
    struct wb_bundle_override *const override = &options->override;

    switch (key) {
    case KEY_VTK_EVERY:
        options->vtk_every = wb_command_integer(state, "--vtk-every", argument, 1, 100000);
        return 0;
    case KEY_THREADS:
        options->threads = wb_command_integer(state, "--threads", argument, 1, 1024);
        return 0;
    case KEY_CHECKPOINT:
        options->checkpoint = argument;
        return 0;
    case KEY_CHECKPOINT_MINUTES:
        options->checkpoint_interval =
            60.0 * wb_command_number(state, "--checkpoint-minutes", argument, 1e-3, 1e5);
        return 0;
    case KEY_MESH:
        override->mesh = argument;
        return 0;
    case KEY_DEAD_FORCE:
        override->dead_force = true;
        return 0;
    case KEY_NO_WEIGHT:
        override->no_weight = true;
        return 0;
    case KEY_DURATION:
        override->duration = wb_command_number(state, "--duration-s", argument, 1e-6, 1e6);
        return 0;
    case KEY_MASS_SCALING:
        override->mass_scaling = wb_command_number(state, "--mass-scaling", argument, 1.0, 1e6);
        return 0;
    case KEY_SELECTIVE:
        override->selective = wb_command_number(state, "--selective", argument, 1.0, 1e6);
        return 0;
    case KEY_FRICTION:
        take_friction(state, argument, override);
        return 0;
    case KEY_COHESIVE_STIFFNESS:
        override->cohesive_stiffness =
            WB_N_PER_MM3 * wb_command_number(state, "--cohesive-stiffness", argument, 1e-6, 1e9);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_solve_options *o = state->input;

    if (key >= KEY_WIRE && key <= KEY_POINTS)
        o->cantilever_option = option_name(key);
    if (key >= KEY_MESH && key <= KEY_CHECKPOINT_MINUTES) {
        o->bundle_option = option_name(key);
        return take_bundle_option(key, argument, state, o);
    }
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
    case KEY_VTK:
        o->vtk = argument;
        return 0;
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

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "cantilever\nwire3d MODEL.yaml\nwire1d MODEL.yaml\nbundle BUNDLE.yaml",
    .doc = "Computes a bending test and prints its curve as CSV, or as JSON, or writes it as a "
           "dataset. cantilever is the 1D beam model of a homogenised wire, described by options. "
           "wire3d and wire1d compute a model file (fixtures/models, by name or path): as a 3D "
           "solid, or as a rod of fibres. bundle computes a bundle file (fixtures/bundles), wires "
           "with contact and tape, in explicit dynamics.\v"
           "Exit code 3: the curve was cut short because the solver did not converge, or by "
           "Ctrl-C; what was computed is there.",
};

void wb_solve_print_header(void)
{
    puts("cycle,phase,deflection_mm,tension_N,force_N,tip_x_mm,tip_angle_rad");
}

void wb_solve_print_point(const struct wb_solve_point *point)
{
    const double column[] = {point->deflection / WB_MM, point->tension, point->force,
                             point->tip_x / WB_MM, point->tip_angle};
    printf("%d,%s", point->cycle, wb_history_phase_text(point->phase));
    for (size_t k = 0; k < sizeof column / sizeof column[0]; k++) {
        char text[WB_NUMBER_TEXT];
        printf(",%s", wb_number_format(column[k], text));
    }
    putchar('\n');
}

void wb_solve_set_point(struct wb_json *object, const struct wb_solve_point *point)
{
    wb_json_set_integer(object, "cycle", point->cycle);
    wb_json_set_text(object, "phase", wb_history_phase_text(point->phase));
    wb_json_set_number(object, "deflection_mm", point->deflection / WB_MM);
    wb_json_set_number(object, "tension_N", point->tension);
    wb_json_set_number(object, "force_N", point->force);
    wb_json_set_number(object, "tip_x_mm", point->tip_x / WB_MM);
    wb_json_set_number(object, "tip_angle_rad", point->tip_angle);
}

static double seconds(clockid_t clock)
{
    struct timespec now = {0};
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct wb_solve_time wb_solve_now(void)
{
    return (struct wb_solve_time){.wall = seconds(CLOCK_MONOTONIC),
                                  .cpu = seconds(CLOCK_PROCESS_CPUTIME_ID)};
}

int wb_cmd_solve(int argc, char **argv)
{
    struct wb_solve_options options = {.points = DEFAULT_POINTS};
    wb_command_parse(&argp, argc, argv, &options);
    wb_interrupt_install();
    switch (options.kind) {
    case WB_SOLVE_CANTILEVER:
        return wb_solve_cantilever(&options);
    case WB_SOLVE_BUNDLE:
        return wb_solve_bundle(&options);
    default:
        return wb_solve_wire(&options);
    }
}
