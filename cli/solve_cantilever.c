/* wirebench solve cantilever: a bending test with the 1D beam. */
#include <math.h>
#include <stdio.h>

#include "analysis/simulated.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/solve.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 7
};

/* Inputs and results of a run. */
struct run {
    const struct wb_solve_options *options;
    struct wb_wire wire;
    struct wb_material material;
    struct wb_section section;
    struct wb_cantilever *cantilever;
    struct wb_loading_steps loading;
    struct wb_progress progress;
    double done; /* rows */
    double marker[MARKERS];
    double wall, cpu; /* s */
};

static enum wb_status prepare(struct run *run)
{
    const struct wb_solve_options *o = run->options;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "wires", o->wire, NULL));
    WB_TRY(wb_wire_read(path, &run->wire, NULL));
    if (!run->wire.has_properties)
        return wb_fail(WB_ERR_DATA, "%s: the wire has no `properties` to compute with", path);
    run->material = run->wire.material;
    if (o->law == WB_SOLVE_ELASTIC)
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

static enum wb_status compute(struct run *run)
{
    const struct wb_loading_steps_plan plan = {
        .control = WB_CONTROL_DEFLECTION,
        .maximum = run->options->deflection,
        .steps = run->options->points,
        .cycles = run->options->cycles,
        .n_shape = MARKERS,
        .shape_s = run->marker,
        .stop = report_progress,
        .stop_context = run,
    };
    WB_TRY(wb_loading_steps_init(&run->loading, &plan));

    const struct wb_solve_time start = wb_solve_now();
    wb_progress_start(&run->progress, "solve", "rows", wb_loading_steps_planned_rows(&plan));
    const enum wb_status status = wb_loading_steps_run(&run->loading, &plan, run->cantilever);
    wb_progress_finish(&run->progress);
    const struct wb_solve_time end = wb_solve_now();
    run->wall = end.wall - start.wall;
    run->cpu = end.cpu - start.cpu;
    return status;
}

static enum wb_status write_dataset(const struct run *run)
{
    const struct wb_solve_options *o = run->options;
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
        .model = o->kind_name,
        .law = o->law == WB_SOLVE_ELASTIC ? "elastic" : "elastoplastic",
        .source = run->wire.source,
        .material = &run->material,
        .wall = run->wall,
        .cpu = run->cpu,
    };
    struct wb_dataset dataset;

    snprintf(info.wire, sizeof info.wire, "%s", run->wire.name);
    WB_TRY(wb_dataset_init(&dataset));
    enum wb_status status = wb_simulated_fill(&dataset, &info, &run->loading, run->marker, &origin);
    if (status == WB_OK)
        status = wb_dataset_write(&dataset, o->common.output, o->common.force);
    wb_dataset_release(&dataset);
    return status;
}

static struct wb_solve_point point_of(const struct wb_loading_steps_row *row)
{
    return (struct wb_solve_point){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->point.deflection,
        .tension = row->point.tension,
        .force = row->force,
        .tip_x = row->point.tip_x,
        .tip_angle = row->point.tip_angle,
    };
}

static int print_json(const struct run *run)
{
    struct wb_json *root = wb_json_create();
    struct wb_json *points = wb_json_set_array(root, "points");

    for (int i = 0; i < run->loading.n_rows; i++) {
        const struct wb_solve_point point = point_of(&run->loading.rows[i]);
        wb_solve_set_point(wb_json_append_object(points), &point);
    }
    wb_json_set_boolean(root, "converged", run->loading.converged);
    wb_json_set_number(root, "wall_s", run->wall);
    wb_json_set_number(root, "cpu_s", run->cpu);
    return wb_command_print_json(root);
}

static void print_csv(const struct run *run)
{
    wb_solve_print_header();
    for (int i = 0; i < run->loading.n_rows; i++) {
        const struct wb_solve_point point = point_of(&run->loading.rows[i]);
        wb_solve_print_point(&point);
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
    if (!run->loading.converged)
        wb_warn("the solver did not converge beyond a deflection of %.4g mm; the curve ends at "
                "row %d",
                run->loading.end.deflection / WB_MM, run->loading.n_rows);
    if (run->loading.stopped)
        wb_warn("stopped after %d rows", run->loading.n_rows);
    return run->loading.converged && !run->loading.stopped ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_solve_cantilever(const struct wb_solve_options *options)
{
    struct run run = {.options = options};
    enum wb_status status = prepare(&run);
    if (status == WB_OK)
        status = compute(&run);
    const int code = status == WB_OK ? deliver(&run) : wb_command_exit(status);

    wb_loading_steps_release(&run.loading);
    wb_cantilever_destroy(run.cantilever);
    wb_section_release(&run.section);
    return code;
}
