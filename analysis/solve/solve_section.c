/* A bundle file in the section model. */
#include <math.h>
#include <stdio.h>

#include "analysis/dataset/simulated_section.h"
#include "analysis/predict/bands_output.h"
#include "analysis/predict/sweep.h"
#include "analysis/solve/solve_kind.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "fe/section/section_run.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 26
};

static const double allowed_imbalance = 0.01;

struct run {
    struct wb_solve solve;
    struct wb_bundle_model model;
    struct wb_section_run result;
    struct wb_bands *bands; /* NULL: not requested */
};

/* --- preparation --- */

/* A given option that applies only to a mesh or to explicit dynamics; NULL: none. */
static const char *find_explicit(const struct wb_bundle_override *override)
{
    static const int tables[] = {WB_BUNDLE_OVERRIDE_MESH, WB_BUNDLE_OVERRIDE_RUN};

    for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[tables[t]];
        for (size_t i = 0; i < table->n; i++)
            if (wb_setting_is_given(&table->rows[i], (const char *) override + table->offset))
                return table->rows[i].option;
    }
    return NULL;
}

/* Rejects options of the explicit model. */
static enum wb_status reject_explicit_options(const struct wb_solve_settings *s)
{
    const char *const option = s->vtk           ? "vtk"
                               : s->checkpoint  ? "checkpoint"
                               : s->threads > 1 ? "threads"
                                                : find_explicit(&s->override);
    if (!option)
        return WB_OK;
    return wb_fail(WB_ERR_ARGUMENT,
                   "--%s applies only to --model explicit: remove it, or use --model explicit",
                   option);
}

/* Rejects options whose values bands take from the ranges in the file. */
static enum wb_status reject_ranged_options(const struct wb_bundle_interface *given)
{
    const char *const option = given->has_friction             ? "friction"
                               : given->normal_stiffness > 0.0 ? "cohesive-stiffness"
                                                               : NULL;
    if (!option)
        return WB_OK;
    return wb_fail(WB_ERR_ARGUMENT,
                   "--%s: bands use the range in the file: remove the option, or change "
                   "uncertainty: %s: [least, largest]",
                   option, given->has_friction ? "friction" : "cohesive_stiffness_N_mm3");
}

static enum wb_status prepare(void *context)
{
    struct run *const run = context;
    const struct wb_solve_settings *const s = run->solve.settings;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "bundles", s->model, NULL));
    WB_TRY(reject_explicit_options(s));
    if (s->uncertain)
        WB_TRY(reject_ranged_options(&s->override.interface));
    WB_TRY(wb_bundle_override_read(&run->model, path, &s->override, NULL));
    run->solve.name = run->model.name;
    return wb_section_run_init(&run->result, &run->model, MARKERS);
}

static enum wb_status compute_bands(struct run *run)
{
    const struct wb_solve_settings *const s = run->solve.settings;
    struct wb_bundle_variant variants[WB_BANDS_CASES - 1];
    struct wb_bands_settings settings = {
        .runs = s->runs,
        .seed = (uint64_t)s->seed,
        .override = &s->override,
        .variants = variants,
        .stop = wb_interrupt_stops,
    };
    if (s->sweep)
        WB_TRY(wb_sweep_parse(s->sweep, WB_BANDS_CASES - 1, variants, &settings.n_variants));
    WB_TRY(wb_bands_create(&run->bands, run->model.path, &settings));
    run->solve.stopped = run->bands->stopped;
    return WB_OK;
}

static enum wb_status compute(void *context)
{
    struct run *const run = context;
    const struct wb_section_run_settings settings = {.stop = wb_interrupt_stops};
    const enum wb_status status = wb_section_run(&run->result, &run->model, &settings);

    run->solve.n_rows = run->result.n_rows;
    run->solve.converged = run->result.converged;
    run->solve.stopped = run->result.stopped;
    if (status != WB_OK || !run->solve.settings->uncertain || run->solve.stopped)
        return status;
    return compute_bands(run);
}

/* --- results --- */

static struct wb_simulated_section simulated(const struct run *run)
{
    return (struct wb_simulated_section){
        .model = &run->model,
        .run = &run->result,
        .override = &run->solve.settings->override,
        .wall = run->solve.spent.wall,
        .cpu = run->solve.spent.cpu,
    };
}

static void describe_bands(const struct run *run, struct wb_json *object)
{
    if (run->bands)
        wb_bands_output_describe(run->bands, object);
}

static void fill(const void *context, struct wb_dataset *dataset)
{
    const struct wb_simulated_section section = simulated(context);
    wb_simulated_section_fill(dataset, &section);
    describe_bands(context, wb_json_get(dataset->document, "simulation"));
}

static enum wb_status write(const void *context, const struct wb_dataset *dataset,
                            const char *folder)
{
    const struct run *const run = context;
    const struct wb_simulated_section section = simulated(run);
    WB_TRY(wb_simulated_section_write_energies(dataset, &section, folder));
    return wb_bands_output_write(run->bands, folder);
}

static void take_row(const void *context, int index, struct wb_solve_row *out)
{
    const struct run *const run = context;
    const struct wb_section_run_row *const row = &run->result.rows[index];
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
    const struct wb_simulated_section section = simulated(context);
    wb_simulated_section_describe(object, &section);
    describe_bands(context, object);
}

static bool summarise(const void *context, struct wb_text *text)
{
    const struct run *const run = context;
    if (run->bands)
        wb_bands_output_summarise(run->bands, text);
    return run->bands != NULL;
}

static void warn_not_converged(const void *context)
{
    const struct run *const run = context;
    const struct wb_section_solver_point *const lost = &run->result.lost;
    char why[96];

    if (isfinite(lost->residual))
        snprintf(why, sizeof why, "residual %.2g of the largest force", lost->residual);
    else
        snprintf(why, sizeof why, "forces are not finite there%s",
                 run->model.loads.strand_length > 0.0 ? ": the strand may be too short to reach"
                                                      : "");
    wb_warn("%s: no equilibrium was found beyond %.4g mm (%s); %d of %d rows were computed; use "
            "--model explicit",
            run->model.name, lost->deflection / WB_MM, why, run->result.n_rows,
            run->result.capacity);
}

static void warn(const void *context)
{
    const struct run *const run = context;
    const struct wb_section_run *const r = &run->result;
    const char *const name = run->model.name;
    const double loosens = wb_section_run_loosens(r, &run->model);
    const double folds = wb_section_run_folds(r);

    if (r->is_mean && run->model.packing.n > 1)
        wb_warn("%s: friction decays with the slip rate, which the static section model does not "
                "support: mu = %.4g, the geometric mean of both coefficients, is used; set another "
                "with --friction",
                name, r->friction);
    if (isfinite(loosens))
        wb_warn("%s: from %.3g mm on the circular tape has a plastic strain above 0.01, and its "
                "outline separates from the wires: the section model is too stiff there; use "
                "--model explicit",
                name, loosens / WB_MM);
    if (isfinite(folds))
        wb_warn("%s: from %.3g mm on the bundle bends to a radius below its own depth, where the "
                "section model is not valid: use a smaller deflection, or a longer bundle",
                name, folds / WB_MM);
    if (r->imbalance > allowed_imbalance)
        wb_warn("%s: energies differ from the work by up to %.3g of it: use more rows (run: rows) "
                "for smaller increments",
                name, r->imbalance);
}

static void release(void *context)
{
    struct run *const run = context;
    wb_section_run_release(&run->result);
    wb_bands_destroy(run->bands);
}

const struct wb_solve_kind wb_solve_section = {
    .size = sizeof(struct run),
    .prepare = prepare,
    .compute = compute,
    .fill = fill,
    .write = write,
    .row = take_row,
    .describe = describe,
    .summarise = summarise,
    .warn_not_converged = warn_not_converged,
    .warn = warn,
    .release = release,
};
