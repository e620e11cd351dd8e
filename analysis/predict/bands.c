#include "analysis/predict/bands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/fit.h"
#include "analysis/predict/hypercube.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/units.h"
#include "base/workers.h"
#include "fe/section/section_run.h"

#define WB_LOG_DOMAIN "bands"

enum {
    RUNS = 500,
    LEAST_RUNS = 20, /* the outer 5 % are then one run */
    CURVE = 18       /* most points of a run's M over kappa */
};

static const double ninety = 1.6448536269514722; /* normal quantile of 95 % */
static const double tail = 0.05;
static const double reached = 0.95; /* part of the runs that must reach a place */

/* --- runs --- */

struct curve {
    int n;
    double curvature[CURVE + 1], moment[CURVE + 1]; /* from zero */
};

/* The runs of a case. */
struct runs {
    const struct wb_inputs *inputs;
    const struct wb_bands_settings *settings;
    struct wb_bundle_model model; /* the model before a run's inputs are applied */
    int n, n_rows;
    const double *u;                         /* (n x dimensions) */
    double *values;                          /* (n x columns) */
    double *force;                           /* (n x n_rows) N; NaN: not reached */
    double *springback, *residual_curvature; /* (n) */
    struct curve *curve;
    bool *limited, *lost;
    double *sorted; /* (n) */
    struct wb_progress progress;
    int done;
    enum wb_status status;
};

static void keep_run(struct runs *runs, int index, const struct wb_section_run *run)
{
    double *const force = runs->force + (size_t)index * (size_t)runs->n_rows;
    struct curve *const curve = &runs->curve[index];

    for (int i = 0; i < runs->n_rows; i++)
        force[i] = i < run->n_rows ? run->rows[i].force : (double)NAN;
    runs->springback[index] = wb_section_run_springback(run);
    runs->residual_curvature[index] = wb_section_run_residual_curvature(run);
    runs->lost[index] = !run->converged;
    curve->n = 1; /* at zero */
    for (int i = 0; i < run->n_curve && i < CURVE; i++) {
        curve->curvature[curve->n] = run->curve[i].curvature;
        curve->moment[curve->n++] = run->curve[i].moment;
    }
}

static enum wb_status compute(struct runs *runs, int index, const struct wb_bundle_model *model)
{
    static const struct wb_section_run_settings settings = {.until_free = true,
                                                            .no_rigidities = true};
    struct wb_section_run run;
    WB_TRY(wb_section_run_init(&run, model, 2));
    const enum wb_status status = wb_section_run(&run, model, &settings);
    if (status == WB_OK)
        keep_run(runs, index, &run);
    wb_section_run_release(&run);
    return status;
}

static enum wb_status do_run(void *context, int index)
{
    struct runs *const runs = context;
    const struct wb_inputs *const inputs = runs->inputs;
    struct wb_bundle_model *const model = wb_memory_new(1, sizeof *model);

    *model = runs->model;
    runs->limited[index] =
        !wb_inputs_apply(inputs, runs->u + (size_t)index * (size_t)inputs->n_dimensions, model,
                         runs->values + (size_t)index * (size_t)inputs->n_columns);
    const enum wb_status status = compute(runs, index, model);
    free(model);
    return status;
}

static bool count_run(void *context, int index, enum wb_status status)
{
    struct runs *const runs = context;
    (void)index;
    if (status != WB_OK)
        runs->status = status;
    wb_progress_update(&runs->progress, ++runs->done, NULL);
    const bool stops = runs->settings->stop && runs->settings->stop(runs->settings->context);
    return runs->status == WB_OK && !stops;
}

/* --- bands --- */

/* Median and 90 % band of n numbers, which are sorted in place; without the model's error. */
static struct wb_bands_interval find_band(double *numbers, int n)
{
    const struct wb_fit_band band = wb_fit_band(numbers, (size_t)n, tail);
    return (struct wb_bands_interval){.median = band.median, .low = band.low, .high = band.high};
}

static void widen(struct wb_bands_interval *band, double of)
{
    const double error = ninety * WB_BANDS_MODEL_ERROR * fabs(of);
    band->wide_low = band->median - hypot(band->median - band->low, error);
    band->wide_high = band->median + hypot(band->high - band->median, error);
}

static void widen_all(struct wb_bands_place *places, int n)
{
    double largest = 0.0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, fabs(places[i].band.median));
    for (int i = 0; i < n; i++)
        widen(&places[i].band, largest);
}

static void find_forces(struct runs *runs, struct wb_bands_case *out)
{
    for (int row = 0; row < runs->n_rows; row++) {
        int n = 0;
        for (int i = 0; i < runs->n; i++) {
            const double force = runs->force[(size_t)i * (size_t)runs->n_rows + (size_t)row];
            if (isfinite(force))
                runs->sorted[n++] = force;
        }
        if (n < reached * runs->n)
            break;
        out->force[out->n_force++] = (struct wb_bands_place){
            .at = runs->model.run.deflection * row / (runs->n_rows - 1),
            .band = find_band(runs->sorted, n),
        };
    }
    widen_all(out->force, out->n_force);
}

/* Linear between the points; NaN beyond the last one. */
static double find_moment(const struct curve *curve, double curvature)
{
    int i = 1;
    while (i < curve->n && curve->curvature[i] < curvature)
        i++;
    if (i >= curve->n)
        return (double)NAN;
    const double part =
        (curvature - curve->curvature[i - 1]) / (curve->curvature[i] - curve->curvature[i - 1]);
    return curve->moment[i - 1] + part * (curve->moment[i] - curve->moment[i - 1]);
}

/* Bands up to the curvature that at least 95 % of the runs reach. */
static void find_moments(struct runs *runs, struct wb_bands_case *out)
{
    for (int i = 0; i < runs->n; i++)
        runs->sorted[i] = runs->curve[i].curvature[runs->curve[i].n - 1];
    wb_fit_sort(runs->sorted, (size_t)runs->n);
    const double most = runs->sorted[(int)((1.0 - reached) * runs->n)];
    for (int k = 1; k <= WB_BANDS_MOMENTS && most > 0.0; k++) {
        const double curvature = most * k / WB_BANDS_MOMENTS;
        int n = 0;
        for (int i = 0; i < runs->n; i++) {
            const double moment = find_moment(&runs->curve[i], curvature);
            if (isfinite(moment))
                runs->sorted[n++] = moment;
        }
        out->moment[out->n_moment++] =
            (struct wb_bands_place){.at = curvature, .band = find_band(runs->sorted, n)};
    }
    widen_all(out->moment, out->n_moment);
}

/* Band of one result per run, NaN where a run has none. */
static struct wb_bands_interval find_ratio(struct runs *runs, const double *ratio)
{
    int n = 0;
    for (int i = 0; i < runs->n; i++)
        if (isfinite(ratio[i]))
            runs->sorted[n++] = ratio[i];
    if (n < reached * runs->n) {
        const double none = (double)NAN;
        return (struct wb_bands_interval){none, none, none, none, none};
    }
    struct wb_bands_interval band = find_band(runs->sorted, n);
    widen(&band, band.median);
    return band;
}

/* --- rankings --- */

/* Ranking of one result per run (NaN: none), `stride` values apart. */
static enum wb_status add_ranking(struct runs *runs, const char *of, double at,
                                  const double *result, size_t stride, struct wb_bands_case *out)
{
    const struct wb_inputs *const inputs = runs->inputs;
    const size_t columns = (size_t)inputs->n_columns;
    double *const values = wb_memory_new((size_t)runs->n, columns * sizeof *values);
    struct wb_bands_ranking *const ranking = &out->ranking[out->n_rankings];
    struct wb_ranking_data data = {
        .n_columns = inputs->n_columns,
        .n_groups = inputs->n_groups,
        .columns = values,
        .group = inputs->group,
        .result = runs->sorted,
        .seed = runs->settings->seed,
    };

    for (int i = 0; i < runs->n; i++) {
        if (!isfinite(result[(size_t)i * stride]))
            continue;
        memcpy(values + (size_t)data.n * columns, runs->values + (size_t)i * columns,
               columns * sizeof *values);
        runs->sorted[data.n++] = result[(size_t)i * stride];
    }
    enum wb_status status = WB_OK;
    if (data.n >= inputs->n_columns + 4) {
        *ranking = (struct wb_bands_ranking){.of = of, .at = at};
        status = wb_ranking_compute(&ranking->ranking, &data);
        out->n_rankings++;
    }
    free(values);
    return status;
}

static enum wb_status find_rankings(struct runs *runs, struct wb_bands_case *out)
{
    const int last = runs->n_rows - 1, middle = (runs->n_rows - 1) / 2;
    const size_t rows = (size_t)runs->n_rows;
    const double deflection = runs->model.run.deflection;

    WB_TRY(add_ranking(runs, "force", deflection * middle / last, runs->force + middle, rows, out));
    WB_TRY(add_ranking(runs, "force", deflection, runs->force + last, rows, out));
    return add_ranking(runs, "deflection_springback", deflection, runs->springback, 1, out);
}

/* --- a case --- */

static enum wb_status prepare_model(struct wb_bundle_model *model, const char *path,
                                    const struct wb_bundle_variant *variant,
                                    const struct wb_bands_settings *settings)
{
    WB_TRY(wb_bundle_override_read(model, path, settings->override, variant));
    const double shortest = model->length * (1.0 - model->uncertainty.length);
    if (!(model->run.deflection < shortest))
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: run: deflection_mm: %g mm exceeds the shortest length of the bundle, "
                       "%g mm (uncertainty: length_percent)",
                       path, model->run.deflection / WB_MM, shortest / WB_MM);
    model->run.cycles = 1;
    if (model->run.rows > WB_BANDS_ROWS)
        model->run.rows = WB_BANDS_ROWS;
    return WB_OK;
}

static void take_memory(struct runs *runs, struct wb_memory *memory)
{
    const size_t n = (size_t)runs->n;
    runs->values = wb_memory_take(memory, n, (size_t)runs->inputs->n_columns * sizeof(double));
    runs->force = wb_memory_take(memory, n, (size_t)runs->n_rows * sizeof(double));
    runs->springback = wb_memory_take(memory, n, sizeof(double));
    runs->residual_curvature = wb_memory_take(memory, n, sizeof(double));
    runs->curve = wb_memory_take(memory, n, sizeof *runs->curve);
    runs->limited = wb_memory_take(memory, n, sizeof(bool));
    runs->lost = wb_memory_take(memory, n, sizeof(bool));
    runs->sorted = wb_memory_take(memory, n, sizeof(double));
}

/* The first run is computed alone, so that an error of the model is reported once. */
static enum wb_status run_all(struct runs *runs, const char *name, bool *stopped)
{
    const struct wb_workers workers = {
        .n = runs->n,
        .n_threads = runs->settings->n_threads,
        .job = do_run,
        .done = count_run,
        .context = runs,
    };
    WB_TRY(compute(runs, 0, &runs->model));
    wb_progress_start(&runs->progress, name, "runs", runs->n);
    const int done = wb_workers_run(&workers);
    wb_progress_finish(&runs->progress);
    *stopped = runs->status == WB_OK && done < runs->n;
    return runs->status;
}

static void describe_case(const struct runs *runs, struct wb_bands_case *out)
{
    const struct wb_bundle_model *const m = &runs->model;
    out->n_wires = m->packing.n;
    snprintf(out->packing, sizeof out->packing, "%s", wb_bundle_model_arrangement(m));
    out->layers = m->has_tape ? m->tape.taping.layers / (1.0 - out->variant.lap) : 0.0;
    out->is_round = m->has_tape && m->tape.round;
    out->n_runs = runs->n;
    for (int i = 0; i < runs->n; i++) {
        out->n_lost += runs->lost[i];
        out->n_limited += runs->limited[i];
    }
}

static enum wb_status compute_case(struct wb_bands *bands, struct runs *runs)
{
    struct wb_bands_case *const out = &bands->cases[bands->n_cases];
    struct wb_memory memory = {0};

    runs->n_rows = runs->model.run.rows + 1;
    take_memory(runs, &memory);
    enum wb_status status = run_all(runs, out->variant.name, &bands->stopped);
    if (status == WB_OK && !bands->stopped) {
        describe_case(runs, out);
        find_forces(runs, out);
        find_moments(runs, out);
        out->springback = find_ratio(runs, runs->springback);
        out->residual_curvature_ratio = find_ratio(runs, runs->residual_curvature);
        status = find_rankings(runs, out);
        bands->n_cases++;
    }
    wb_memory_release(&memory);
    return status;
}

static enum wb_status compute_variant(struct wb_bands *bands, const char *path,
                                      const struct wb_bands_settings *settings, const double *u,
                                      const struct wb_bundle_variant *variant)
{
    struct runs *const runs = wb_memory_new(1, sizeof *runs);
    runs->inputs = &bands->inputs;
    runs->settings = settings;
    runs->n = bands->runs;
    runs->u = u;
    bands->cases[bands->n_cases].variant = *variant;
    enum wb_status status = prepare_model(&runs->model, path, variant, settings);
    if (status == WB_OK)
        status = compute_case(bands, runs);
    free(runs);
    return status;
}

/* --- all cases --- */

static enum wb_status compute_all(struct wb_bands *bands, const char *path,
                                  const struct wb_bands_settings *settings)
{
    static const struct wb_bundle_variant file = {.name = "file"};
    const struct wb_bundle_uncertainty *const u = &bands->inputs.uncertainty;
    const bool is_swept = settings->n_variants > 0;
    const struct wb_bundle_variant *const variants = is_swept ? settings->variants : u->scenario;
    const int n = is_swept ? settings->n_variants : u->n_scenarios;
    const int dimensions = bands->inputs.n_dimensions;
    double *const points = wb_memory_new((size_t)bands->runs, (size_t)dimensions * sizeof *points);
    enum wb_status status = WB_OK;

    wb_hypercube_fill(bands->seed, bands->runs, dimensions, points);
    for (int i = -1; i < n && status == WB_OK && !bands->stopped; i++)
        status = compute_variant(bands, path, settings, points, i < 0 ? &file : &variants[i]);
    free(points);
    return status;
}

static enum wb_status init(struct wb_bands *bands, const char *path,
                           const struct wb_bands_settings *settings)
{
    struct wb_bundle_model *const model = wb_memory_new(1, sizeof *model);
    enum wb_status status = wb_bundle_model_read(model, path);
    if (status == WB_OK)
        status = wb_inputs_init(&bands->inputs, model);
    free(model);
    WB_TRY(status);
    bands->runs = settings->runs > 0 ? settings->runs : RUNS;
    bands->seed = settings->seed;
    if (bands->runs < LEAST_RUNS || bands->runs < bands->inputs.n_dimensions + 4 ||
        settings->n_variants >= WB_BANDS_CASES)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%d runs of %d cases: expected at least %d runs, at least four more than "
                       "the %d inputs of a run, and at most %d cases",
                       bands->runs, settings->n_variants + 1, LEAST_RUNS, bands->inputs.n_columns,
                       WB_BANDS_CASES);
    bands->cases = wb_memory_new(WB_BANDS_CASES, sizeof *bands->cases);
    return WB_OK;
}

enum wb_status wb_bands_create(struct wb_bands **out, const char *path,
                               const struct wb_bands_settings *settings)
{
    struct wb_bands *const bands = wb_memory_new(1, sizeof *bands);
    enum wb_status status = init(bands, path, settings);
    if (status == WB_OK)
        status = compute_all(bands, path, settings);
    if (status == WB_OK)
        *out = bands;
    else
        wb_bands_destroy(bands);
    return status;
}

void wb_bands_destroy(struct wb_bands *bands)
{
    if (!bands)
        return;
    free(bands->cases);
    free(bands);
}
