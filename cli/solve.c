#include "cli/solve.h"

#include <stddef.h>
#include <stdio.h>
#include <time.h>

#include "base/number.h"
#include "base/units.h"

static const char *const laws[] = {
    [WB_SOLVE_ELASTOPLASTIC] = "elastoplastic", [WB_SOLVE_ELASTIC] = "elastic", NULL};

static const struct wb_setting rows[] = {
    {.name = "wire",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_options, wire),
     .option = "wire",
     .argument = "NAME|FILE",
     .help = "Wire with its properties, a file or one of fixtures/wires",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "length_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_options, length),
     .scale = WB_MM,
     .least = 1e-3,
     .largest = 1e6,
     .required = true,
     .option = "length-mm",
     .argument = "L",
     .help = "Free length from clamp to tip",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "deflection_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_options, deflection),
     .scale = WB_MM,
     .least = 1e-6,
     .largest = 1e6,
     .required = true,
     .option = "deflection-mm",
     .argument = "D",
     .help = "Largest deflection of the tip",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "law",
     .type = WB_SETTING_CHOICE,
     .offset = offsetof(struct wb_solve_options, law),
     .choices = laws,
     .option = "law",
     .argument = "LAW",
     .help = "Law of the material",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "strand_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_options, strand),
     .scale = WB_MM,
     .least = 1e-3,
     .largest = 1e9,
     .otherwise = "the force is vertical and may push",
     .option = "strand-mm",
     .argument = "S",
     .help = "Length of the strand that raises the tip, fixed straight above the straight wire's "
             "tip",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "weight",
     .type = WB_SETTING_BOOLEAN,
     .offset = offsetof(struct wb_solve_options, weight),
     .option = "weight",
     .help = "Let the wire's weight act, against the deflection",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "cycles",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_options, cycles),
     .least = 1,
     .largest = 1000,
     .otherwise = "load once",
     .option = "cycles",
     .argument = "N",
     .help = "Load and unload N times",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "points",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_options, points),
     .least = 1,
     .largest = 100000,
     .fallback = 53,
     .option = "points",
     .argument = "N",
     .help = "Equal steps to the largest deflection",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "vtk",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_options, vtk),
     .option = "vtk",
     .argument = "DIR",
     .help = "Write every row's stress field for ParaView",
     .applies = WB_SOLVE_WIRE3D | WB_SOLVE_BUNDLE},
    {.name = "vtk_every",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_options, vtk_every),
     .least = 1,
     .largest = 100000,
     .otherwise = "1",
     .option = "vtk-every",
     .argument = "N",
     .help = "With --vtk, write every Nth row only, and the largest deflection",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "threads",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_options, threads),
     .least = 1,
     .largest = 1024,
     .fallback = 1,
     .option = "threads",
     .argument = "N",
     .help = "Compute in N parts along the axis, on as many cores; with mpirun, of each rank",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "checkpoint",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_options, checkpoint),
     .option = "checkpoint",
     .argument = "FILE",
     .help = "Keep the run in this file every so often; a run that was ended goes on from it when "
             "the same command is given again",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "checkpoint_minutes",
     .unit = "minutes",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_options, checkpoint_interval),
     .scale = 60.0,
     .least = 1e-3,
     .largest = 1e5,
     .fallback = 10.0,
     .option = "checkpoint-minutes",
     .argument = "M",
     .help = "Time between checkpoints",
     .applies = WB_SOLVE_BUNDLE},
};

const struct wb_setting_table wb_solve_settings = {.rows = rows, .n = WB_COUNT(rows)};

void wb_solve_print_header(void)
{
    puts("cycle,phase,deflection_mm,tension_N,force_N,tip_x_mm,tip_angle_rad");
}

void wb_solve_print_point(const struct wb_solve_point *point)
{
    const double column[] = {point->deflection / WB_MM, point->tension, point->force,
                             point->tip_x / WB_MM, point->tip_angle};
    printf("%d,%s", point->cycle, wb_trial_phase_name(point->phase));
    for (size_t k = 0; k < sizeof column / sizeof column[0]; k++) {
        char text[WB_NUMBER_TEXT];
        printf(",%s", wb_number_format(column[k], text));
    }
    putchar('\n');
}

void wb_solve_set_point(struct wb_json *object, const struct wb_solve_point *point)
{
    wb_json_set_integer(object, "cycle", point->cycle);
    wb_json_set_text(object, "phase", wb_trial_phase_name(point->phase));
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
