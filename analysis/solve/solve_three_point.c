/* Three-point bending with the 1D beam. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/dataset/simulated.h"
#include "analysis/solve/solve_kind.h"
#include "analysis/solve/solve_law.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "base/units.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "solve"

/* Inputs and results of a run. */
struct run {
    struct wb_solve solve;
    struct wb_wire wire;
    struct wb_law law; /* used in the computation: the wire's, or elastic */
    struct wb_section section;
    struct wb_three_point_bending *bending;
    double curvature; /* natural curvature, 1/m */
    int planned;      /* largest number of rows */
    struct wb_simulated_bending_row *rows;
    enum wb_three_point_bending_end end;
};

static double natural_curvature(void *context, double from_middle)
{
    const double *const curvature = context;
    (void)from_middle;
    return *curvature;
}

static enum wb_status prepare(void *context)
{
    struct run *const run = context;
    const struct wb_solve_settings *const o = run->solve.settings;

    WB_TRY(wb_solve_law_prepare(o->model, o->law == WB_SOLVE_ELASTIC, &run->wire, &run->law,
                                &run->section));
    run->solve.name = run->wire.name;
    if (fabs(o->bow) > 0.5 * o->span)
        return wb_fail(
            WB_ERR_ARGUMENT,
            "--bow-mm: %g mm: the rise of an arc over a span of %g mm is at most half of the span",
            o->bow / WB_MM, o->span / WB_MM);
    run->planned = 1 + o->points * (o->cycles > 0 ? 2 * o->cycles : 1);
    run->rows = wb_memory_new((size_t)run->planned, sizeof *run->rows);
    /* Curvature of the arc whose rise over the span is the bow. */
    run->curvature = 8.0 * o->bow / (o->span * o->span + 4.0 * o->bow * o->bow);
    const struct wb_three_point_bending_model model = {
        .section = &run->section,
        .diameter = run->wire.outer_diameter,
        .span = o->span,
        .overhang = o->overhang,
        .support_radius = o->roller_radius,
        .nose_radius = o->nose_radius,
        .friction = o->friction,
        .compliance = o->compliance,
        .whole = o->whole,
        .natural_curvature = o->bow != 0.0 ? natural_curvature : NULL,
        .curvature_context = &run->curvature,
    };
    return wb_three_point_bending_create(&run->bending, &model);
}

/* Adds one row; false if the test ends with it. */
static bool add_row(struct run *run, int cycle, enum wb_phase phase, double deflection,
                    enum wb_status *status)
{
    struct wb_simulated_bending_row *const row = &run->rows[run->solve.n_rows];
    run->solve.stopped = wb_interrupted();
    if (run->solve.stopped)
        return false;
    wb_progress_update(&run->solve.progress, run->solve.n_rows, NULL);
    *status = wb_three_point_bending_move(run->bending, deflection, &row->point);
    if (*status != WB_OK)
        return false;
    run->end = row->point.end;
    if (run->end != WB_THREE_POINT_BENDING_CONVERGED)
        return false;
    row->cycle = cycle;
    row->phase = phase == WB_PHASE_UNLOAD && row->point.slack ? WB_PHASE_SLACK : phase;
    run->solve.n_rows++;
    return true;
}

static enum wb_status compute(void *context)
{
    struct run *const run = context;
    const struct wb_solve_settings *const o = run->solve.settings;
    const int cycles = o->cycles > 0 ? o->cycles : 1;
    enum wb_status status = WB_OK;

    wb_progress_start(&run->solve.progress, "solve", "rows", run->planned);
    bool goes_on = add_row(run, 1, WB_PHASE_LOAD, 0.0, &status);
    int at = 0; /* steps from zero */
    for (int cycle = 1; goes_on && cycle <= cycles; cycle++) {
        while (goes_on && at < o->points) {
            at++;
            goes_on = add_row(run, cycle, WB_PHASE_LOAD, o->deflection * at / o->points, &status);
        }
        while (goes_on && o->cycles > 0 && at > 0) {
            at--;
            goes_on = add_row(run, cycle, WB_PHASE_UNLOAD, o->deflection * at / o->points, &status);
            if (goes_on && run->rows[run->solve.n_rows - 1].phase == WB_PHASE_SLACK)
                break;
        }
    }
    wb_progress_finish(&run->solve.progress);
    run->solve.converged = run->end == WB_THREE_POINT_BENDING_CONVERGED;
    return status;
}

static struct wb_band known(double value)
{
    return (struct wb_band){true, value, value, value};
}

static const struct wb_band unknown = {false, (double)NAN, (double)NAN, (double)NAN};

static void fill(const void *context, struct wb_dataset *dataset)
{
    const struct run *const run = context;
    const struct wb_solve_settings *const o = run->solve.settings;
    const double overhang = o->overhang > 0.0 ? o->overhang : 0.3 * o->span;
    struct wb_test_info info = {
        .length = o->span,
        .outer_diameter = run->wire.outer_diameter,
        .mass_per_length = wb_wire_mass_per_length(&run->wire),
        .poissons_ratio = run->law.material.poissons_ratio,
        .rest_level = (double)NAN,
        .is_simulation = true,
        .kind = WB_TEST_THREE_POINT,
        .has_machine = true,
        .machine = {.name = "computed",
                    .kind = WB_TEST_THREE_POINT,
                    .compliance = known(o->compliance),
                    .speed = unknown,
                    .span = o->span,
                    .roller_radius = o->roller_radius,
                    .nose_radius = known(o->nose_radius),
                    .friction = known(o->friction)},
        .piece = {.outer_diameter = run->wire.outer_diameter,
                  .length = o->span + 2.0 * overhang,
                  .mass_per_length = wb_wire_mass_per_length(&run->wire),
                  .usable_travel = unknown,
                  .natural_bow = known(o->bow),
                  .area = (double)NAN},
    };
    const struct wb_simulated_origin origin = {
        .model = wb_solve_settings_kind(o),
        .source = run->wire.source,
        .law = &run->law,
        .wall = run->solve.spent.wall,
        .cpu = run->solve.spent.cpu,
    };
    const struct wb_simulated_bending bending = {
        .n_rows = run->solve.n_rows, .rows = run->rows, .converged = run->solve.converged};

    snprintf(info.wire, sizeof info.wire, "%s", run->wire.name);
    snprintf(info.piece.wire, sizeof info.piece.wire, "%s", run->wire.name);
    wb_simulated_fill_three_point(dataset, &info, &bending, &origin);
}

static void take_row(const void *context, int index, struct wb_solve_row *out)
{
    const struct run *const run = context;
    const struct wb_simulated_bending_row *const row = &run->rows[index];
    *out = (struct wb_solve_row){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->point.travel,
        .tension = row->point.force,
        .force = row->point.force,
        .tip_x = (double)NAN,
        .tip_angle = (double)NAN,
        .bending = &row->point,
    };
}

static void describe(const void *context, struct wb_json *object)
{
    const struct run *const run = context;
    wb_json_set_boolean(object, "converged", run->solve.converged);
    wb_json_set_text(object, "end", wb_three_point_bending_end_name(run->end));
    wb_json_set_number(object, "contact_level_mm",
                       wb_three_point_bending_contact_level(run->bending) / WB_MM);
    wb_json_set_number(object, "wall_s", run->solve.spent.wall);
    wb_json_set_number(object, "cpu_s", run->solve.spent.cpu);
}

static void warn_not_converged(const void *context)
{
    const struct run *const run = context;
    /* The point that was not reached follows the last row. */
    const double at = run->rows[run->solve.n_rows].point.deflection / WB_MM;
    if (run->end == WB_THREE_POINT_BENDING_RAN_OFF)
        wb_warn("the wire's end reaches a roller at a deflection of %.4g mm: use a longer "
                "overhang; the curve ends at row %d",
                at, run->solve.n_rows);
    else if (run->end == WB_THREE_POINT_BENDING_PINCHED)
        wb_warn("the wire is pinched between nose and rollers at a deflection of %.4g mm; the "
                "curve ends at row %d",
                at, run->solve.n_rows);
    else
        wb_warn("the solver did not converge beyond a deflection of %.4g mm; the curve ends at row "
                "%d",
                at, run->solve.n_rows);
}

static void release(void *context)
{
    struct run *const run = context;
    wb_three_point_bending_destroy(run->bending);
    wb_section_release(&run->section);
    free(run->rows);
}

const struct wb_solve_kind wb_solve_three_point = {
    .size = sizeof(struct run),
    .prepare = prepare,
    .compute = compute,
    .fill = fill,
    .row = take_row,
    .describe = describe,
    .warn_not_converged = warn_not_converged,
    .release = release,
};
