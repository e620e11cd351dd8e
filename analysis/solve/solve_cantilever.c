/* A bending test with the 1D beam. */
#include <math.h>
#include <stdio.h>

#include "analysis/dataset/simulated.h"
#include "analysis/solve/solve_kind.h"
#include "analysis/solve/solve_law.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 7
};

/* Inputs and results of a run. */
struct run {
    struct wb_solve solve;
    struct wb_wire wire;
    struct wb_law law; /* used in the computation: the wire's, or elastic */
    struct wb_section section;
    struct wb_cantilever *cantilever;
    struct wb_loading_steps loading;
    double done; /* rows */
    double marker[MARKERS];
};

static enum wb_status prepare(void *context)
{
    struct run *const run = context;
    const struct wb_solve_settings *const o = run->solve.settings;

    WB_TRY(wb_solve_law_prepare(o->wire, o->law == WB_SOLVE_ELASTIC, &run->wire, &run->law,
                                &run->section));
    run->solve.name = run->wire.name;

    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
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
    wb_progress_update(&run->solve.progress, run->done++, NULL);
    return wb_interrupted();
}

static enum wb_status compute(void *context)
{
    struct run *const run = context;
    const struct wb_loading_steps_plan plan = {
        .control = WB_CONTROL_DEFLECTION,
        .maximum = run->solve.settings->deflection,
        .steps = run->solve.settings->points,
        .cycles = run->solve.settings->cycles,
        .n_shape = MARKERS,
        .shape_s = run->marker,
        .stop = report_progress,
        .stop_context = run,
    };
    WB_TRY(wb_loading_steps_init(&run->loading, &plan));

    wb_progress_start(&run->solve.progress, "solve", "rows", wb_loading_steps_planned_rows(&plan));
    const enum wb_status status = wb_loading_steps_run(&run->loading, &plan, run->cantilever);
    wb_progress_finish(&run->solve.progress);
    run->solve.n_rows = run->loading.n_rows;
    run->solve.converged = run->loading.converged;
    run->solve.stopped = run->loading.stopped;
    return status;
}

static void fill(const void *context, struct wb_dataset *dataset)
{
    const struct run *const run = context;
    const struct wb_solve_settings *const o = run->solve.settings;
    struct wb_test_info info = {
        .length = o->length,
        .outer_diameter = run->wire.outer_diameter,
        .mass_per_length = wb_wire_mass_per_length(&run->wire),
        .poissons_ratio = run->law.material.poissons_ratio,
        .strand_length = o->strand,
        .gravity = o->weight ? WB_STANDARD_GRAVITY : 0.0,
        .rest_level = (double)NAN,
        .is_simulation = true,
    };
    const struct wb_simulated_cantilever cantilever = {
        .law = &run->law,
        .outer_diameter = run->wire.outer_diameter,
        .length = o->length,
        .deflection = o->deflection,
        .strand_length = o->strand,
        .mass_per_length = o->weight ? wb_wire_mass_per_length(&run->wire) : 0.0,
        .points = o->points,
        .cycles = o->cycles,
    };
    const struct wb_simulated_origin origin = {
        .model = wb_solve_settings_kind(o),
        .source = run->wire.source,
        .law = &run->law,
        .wall = run->solve.spent.wall,
        .cpu = run->solve.spent.cpu,
        .cantilever = &cantilever,
    };

    snprintf(info.wire, sizeof info.wire, "%s", run->wire.name);
    wb_simulated_fill(dataset, &info, &run->loading, run->marker, &origin);
}

static void take_row(const void *context, int index, struct wb_solve_row *out)
{
    const struct run *const run = context;
    const struct wb_loading_steps_row *const row = &run->loading.rows[index];
    *out = (struct wb_solve_row){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->point.deflection,
        .tension = row->point.tension,
        .force = row->force,
        .tip_x = row->point.tip_x,
        .tip_angle = row->point.tip_angle,
    };
}

static void describe(const void *context, struct wb_json *object)
{
    const struct run *const run = context;
    wb_json_set_boolean(object, "converged", run->loading.converged);
    wb_json_set_number(object, "wall_s", run->solve.spent.wall);
    wb_json_set_number(object, "cpu_s", run->solve.spent.cpu);
}

static void warn_not_converged(const void *context)
{
    const struct run *const run = context;
    wb_warn("the solver did not converge beyond a deflection of %.4g mm; the curve ends at row %d",
            run->loading.end.deflection / WB_MM, run->loading.n_rows);
}

static void release(void *context)
{
    struct run *const run = context;
    wb_loading_steps_release(&run->loading);
    wb_cantilever_destroy(run->cantilever);
    wb_section_release(&run->section);
}

const struct wb_solve_kind wb_solve_cantilever = {
    .size = sizeof(struct run),
    .prepare = prepare,
    .compute = compute,
    .fill = fill,
    .row = take_row,
    .describe = describe,
    .warn_not_converged = warn_not_converged,
    .release = release,
};
