#include "analysis/harness/harness_bands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/harness/harness_found.h"
#include "analysis/predict/hypercube.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/vec3.h"
#include "base/workers.h"

#define WB_LOG_DOMAIN "harness"

/* Results of a run, as doubles: RUN_VALUES of the run; then for each step whether its snaps are
 * others than the nominal ones, FORCE_VALUES of each item, and SHAPE_VALUES of each branch. */
enum {
    COMPLETED, /* steps with an equilibrium */
    LOST_IN,   /* branch without an equilibrium; -1: the root, or none */
    RESIDUAL,  /* m, largest distance from the stress-free shape at the end */
    RUN_VALUES
};
enum {
    FORCE,
    MOMENT,
    LARGEST_FORCE,
    LARGEST_MOMENT,
    FORCE_VALUES
};
enum {
    DISTANCE,
    AT,
    SHAPE_VALUES
};

static const double tail = 0.5 * (1.0 - WB_HARNESS_BANDS_CONFIDENCE);
static const double reached = 0.95;   /* part of the runs that must reach a step */
static const double most_bytes = 4e9; /* of the results of the runs */
static const int wires_of_a_branch = 1;

static double *run_values(const struct wb_harness_bands *bands, int run)
{
    return bands->values + (size_t)run * bands->stride;
}

static size_t step_offset(const struct wb_harness_plan *plan, int step)
{
    const int of_step = 1 + FORCE_VALUES * plan->n_items + SHAPE_VALUES * plan->n_branches;
    return RUN_VALUES + (size_t)step * (size_t)of_step;
}

static double *step_values(const struct wb_harness_bands *bands, int run, int step)
{
    return run_values(bands, run) + step_offset(bands->nominal->plan, step);
}

static double *force_values(const struct wb_harness_bands *bands, int run, int step, int item)
{
    return step_values(bands, run, step) + 1 + FORCE_VALUES * item;
}

static double *shape_values(const struct wb_harness_bands *bands, int run, int step, int branch)
{
    return force_values(bands, run, step, bands->nominal->plan->n_items) + SHAPE_VALUES * branch;
}

/* --- draws --- */

bool wb_harness_bands_is_drawn(const struct wb_harness_wire *wire)
{
    return wire->specimens.n > 0;
}

/* The first wire of the same file, which has the same draw. */
static int same_wire(const struct wb_harness_plan *plan, int wire)
{
    int i = 0;
    while (strcmp(plan->wires[i].sha256, plan->wires[wire].sha256) != 0)
        i++;
    return i;
}

static int count_dimensions(const struct wb_harness_plan *plan)
{
    int n = 0;
    for (int i = 0; i < plan->n_wires; i++)
        if (wb_harness_bands_is_drawn(&plan->wires[i]) && same_wire(plan, i) == i)
            n += wb_specimens_dimensions(&plan->wires[i].specimens);
    return n;
}

/* Draws the laws of a run from its numbers u. */
static void draw_laws(struct wb_harness_plan *plan, const double *u)
{
    for (int i = 0; i < plan->n_wires; i++) {
        struct wb_harness_wire *const wire = &plan->wires[i];
        const int same = same_wire(plan, i);
        double q[WB_SPECIMENS_QUANTITIES];
        if (!wb_harness_bands_is_drawn(wire))
            continue;
        if (same < i) {
            wire->law = plan->wires[same].law;
            continue;
        }
        wb_specimens_draw(&wire->specimens, wires_of_a_branch, u, q);
        u += wb_specimens_dimensions(&wire->specimens);
        (void)wb_specimens_shift(&wire->specimens, q, &wire->law);
    }
}

/* --- runs --- */

struct job {
    struct wb_harness_bands *bands;
    int first, done;
    enum wb_status status;
    struct wb_progress progress;
};

static bool go_on(void *context, double fraction)
{
    const struct wb_harness_bands_settings *const s = context;
    (void)fraction;
    return !s->stop || !s->stop(s->context);
}

/* The branches that snapped in the steps up to a step, in order, are those of the nominal laws. */
static bool snaps_as(const struct wb_harness_step_result *nominal,
                     const struct wb_harness_step_result *results, int step)
{
    const struct wb_harness_step_result *const sets[2] = {nominal, results};
    int at[2] = {0, 0}, snap[2] = {0, 0};
    for (;;) {
        int branch[2];
        for (int k = 0; k < 2; k++) {
            while (at[k] <= step && snap[k] == sets[k][at[k]].n_snaps) {
                at[k]++;
                snap[k] = 0;
            }
            branch[k] = at[k] <= step ? sets[k][at[k]].snap_branch[snap[k]++] : -2;
        }
        if (branch[0] != branch[1])
            return false;
        if (branch[0] == -2)
            return true;
    }
}

static void keep_forces(const struct wb_harness_bands *bands, int run, int step,
                        const struct wb_harness_step_result *result)
{
    for (int i = 0; i < bands->nominal->plan->n_items; i++) {
        const struct wb_harness_force *const f = &result->forces[i];
        double *const values = force_values(bands, run, step, i);
        values[FORCE] = f->size;
        values[MOMENT] = f->moment_size;
        values[LARGEST_FORCE] = f->largest;
        values[LARGEST_MOMENT] = f->largest_moment;
    }
}

static void keep_shapes(const struct wb_harness_bands *bands, int run, int step,
                        const struct wb_harness_step_result *result)
{
    const struct wb_harness_result_set *const nominal = bands->nominal;
    double residual = 0.0;
    for (int i = 0; i < nominal->n_places; i++) {
        const struct wb_harness_place *const place = &result->places[i];
        double *const values = shape_values(bands, run, step, place->branch);
        const double distance =
            wb_vec3_distance(place->position, nominal->results[step].places[i].position);
        residual = fmax(residual, wb_vec3_distance(place->position, nominal->natural[i].position));
        if (distance > values[DISTANCE]) {
            values[DISTANCE] = distance;
            values[AT] = place->s;
        }
    }
    run_values(bands, run)[RESIDUAL] = residual;
}

static void take_steps(struct wb_harness_bands *bands, int index, struct wb_harness_run *run,
                       struct wb_harness_step_result *results)
{
    const struct wb_harness_result_set *const nominal = bands->nominal;
    double *const values = run_values(bands, index);
    for (int i = 0; i < nominal->n_steps; i++) {
        wb_harness_run_step(run, &nominal->plan->steps[i], go_on, &bands->settings, &results[i]);
        values[LOST_IN] = results[i].worst_branch;
        if (results[i].end != WB_HARNESS_CONVERGED)
            return;
        values[COMPLETED] = i + 1;
        step_values(bands, index, i)[0] = !snaps_as(nominal->results, results, i);
        keep_forces(bands, index, i, &results[i]);
        keep_shapes(bands, index, i, &results[i]);
    }
}

static enum wb_status do_run(void *context, int index)
{
    struct job *const job = context;
    struct wb_harness_bands *const bands = job->bands;
    const struct wb_harness_result_set *const nominal = bands->nominal;
    struct wb_harness_plan *const plan = wb_memory_new(1, sizeof *plan);
    struct wb_memory memory = {0};
    struct wb_harness_run *run;

    index += job->first;
    *plan = *nominal->plan;
    draw_laws(plan, bands->points + (size_t)index * (size_t)bands->n_dimensions);
    const enum wb_status status = wb_harness_run_create(&run, plan, &nominal->settings);
    if (status == WB_OK) {
        struct wb_harness_step_result *const results =
            wb_memory_take(&memory, (size_t)nominal->n_steps, sizeof *results);
        for (int i = 0; i < nominal->n_steps; i++)
            wb_harness_run_take_memory(run, &memory, &results[i]);
        take_steps(bands, index, run, results);
        wb_harness_run_destroy(run);
    }
    wb_memory_release(&memory);
    free(plan);
    return status;
}

static bool count_run(void *context, int index, enum wb_status status)
{
    struct job *const job = context;
    (void)index;
    if (status != WB_OK)
        job->status = status;
    wb_progress_update(&job->progress, ++job->done, NULL);
    return job->status == WB_OK && go_on(&job->bands->settings, 0.0);
}

enum wb_status wb_harness_bands_compute(struct wb_harness_bands *bands, int first, int n)
{
    struct job job = {.bands = bands, .first = first};
    const struct wb_workers workers = {
        .n = n,
        .n_threads = bands->settings.n_threads,
        .job = do_run,
        .done = count_run,
        .context = &job,
    };
    wb_progress_start(&job.progress, "bands", "runs", n);
    const int done = wb_workers_run(&workers);
    wb_progress_finish(&job.progress);
    /* The last run may have been stopped on its way. */
    bands->stopped |= done < n || !go_on(&bands->settings, 0.0);
    return job.status;
}

/* --- bands --- */

/* Band of one value of all runs that completed a step. */
static struct wb_fit_band find_band(const struct wb_harness_bands *bands, int step,
                                    const double *of_first, double *sorted)
{
    const size_t offset = (size_t)(of_first - bands->values);
    int n = 0;
    for (int run = 0; run < bands->settings.runs; run++)
        if (run_values(bands, run)[COMPLETED] > step)
            sorted[n++] = run_values(bands, run)[offset];
    if (n < reached * bands->settings.runs)
        return (struct wb_fit_band){(double)NAN, (double)NAN, (double)NAN};
    return wb_fit_band(sorted, (size_t)n, tail);
}

static void find_forces(const struct wb_harness_bands *bands, int step, double *sorted)
{
    for (int i = 0; i < bands->nominal->plan->n_items; i++) {
        struct wb_harness_force_bands *const f = &bands->steps[step].forces[i];
        const double *const first = force_values(bands, 0, step, i);
        f->force = find_band(bands, step, first + FORCE, sorted);
        f->moment = find_band(bands, step, first + MOMENT, sorted);
        f->largest_force = find_band(bands, step, first + LARGEST_FORCE, sorted);
        f->largest_moment = find_band(bands, step, first + LARGEST_MOMENT, sorted);
    }
}

/* The place is that of a run with this distance. */
static void find_shape(const struct wb_harness_bands *bands, int step, int branch, double *sorted)
{
    struct wb_harness_shape_band *const shape = &bands->steps[step].branches[branch];
    shape->median = find_band(bands, step, shape_values(bands, 0, step, branch), sorted).median;
    shape->distance = shape->at = (double)NAN;
    if (!isfinite(shape->median))
        return;
    const int last = bands->steps[step].n - 1;
    shape->distance = sorted[(int)ceil(WB_HARNESS_BANDS_CONFIDENCE * last)];
    for (int run = 0; run < bands->settings.runs && !isfinite(shape->at); run++) {
        const double *const values = shape_values(bands, run, step, branch);
        if (run_values(bands, run)[COMPLETED] > step && values[DISTANCE] == shape->distance)
            shape->at = values[AT];
    }
}

static void count_runs(struct wb_harness_bands *bands)
{
    for (int run = 0; run < bands->settings.runs; run++) {
        const double *const values = run_values(bands, run);
        const int completed = (int)values[COMPLETED];
        struct wb_harness_deviant deviant = {.run = run + 1, .step = -1, .branch = -1};
        for (int i = 0; i < completed; i++) {
            const bool is_other = step_values(bands, run, i)[0] != 0.0;
            bands->steps[i].n++;
            bands->steps[i].n_other += is_other;
            if (is_other && deviant.step < 0)
                deviant.step = i;
        }
        if (completed < bands->nominal->n_steps) {
            bands->steps[completed].n_lost++;
            deviant.step = completed;
            deviant.is_lost = true;
            deviant.branch = (int)values[LOST_IN];
        }
        if (deviant.step >= 0)
            bands->deviants[bands->n_deviants++] = deviant;
    }
}

void wb_harness_bands_finish(struct wb_harness_bands *bands)
{
    const struct wb_harness_result_set *const nominal = bands->nominal;
    const int last = nominal->n_steps - 1;
    double *const sorted = wb_memory_new((size_t)bands->settings.runs, sizeof *sorted);
    struct wb_harness_found found;
    count_runs(bands);
    for (int step = 0; step <= last; step++) {
        find_forces(bands, step, sorted);
        for (int b = 0; b < nominal->plan->n_branches; b++)
            find_shape(bands, step, b, sorted);
    }
    wb_harness_found_collect(&found, nominal);
    bands->is_taken_off = found.is_taken_off;
    if (bands->is_taken_off)
        bands->residual = find_band(bands, last, run_values(bands, 0) + RESIDUAL, sorted);
    free(sorted);
}

/* --- the object --- */

static enum wb_status reject_wires(const struct wb_harness_plan *plan)
{
    struct wb_text names = {0};
    for (int i = 0; i < plan->n_wires; i++)
        wb_text_append(&names, "%s%s (%s)", i > 0 ? ", " : "", plan->wires[i].name,
                       plan->wires[i].file);
    const enum wb_status status = wb_fail(
        WB_ERR_ARGUMENT,
        "%s: wires: bands need the scatter of specimens, and the file of no wire has it: %s; name "
        "a properties file of 'wirebench calibrate' with at least %d specimens, tested in whole "
        "cycles",
        plan->path, wb_text_string(&names), WB_SPECIMENS_LEAST);
    wb_text_release(&names);
    return status;
}

enum wb_status wb_harness_bands_check(const struct wb_harness_plan *plan, int runs)
{
    const int least = count_dimensions(plan) + 4 > WB_HARNESS_BANDS_LEAST_RUNS
                          ? count_dimensions(plan) + 4
                          : WB_HARNESS_BANDS_LEAST_RUNS;
    if (count_dimensions(plan) == 0)
        return reject_wires(plan);
    if (runs < least)
        return wb_fail(WB_ERR_ARGUMENT, "--runs: %d runs: expected at least %d for bands of 95 %%",
                       runs, least);
    return WB_OK;
}

static enum wb_status check(const struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = bands->nominal->plan;
    const int runs = bands->settings.runs;
    const double bytes = (double)runs * (double)bands->stride * sizeof(double);
    WB_TRY(wb_harness_bands_check(plan, runs));
    if (!bands->nominal->converged)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: steps: no bands: a step of the nominal wires finds no "
                       "equilibrium",
                       plan->path);
    if (bytes > most_bytes)
        return wb_fail(WB_ERR_ARGUMENT,
                       "--runs: the results of %d runs of this harness take %.3g GB: expected at "
                       "most %.3g GB, with fewer runs",
                       runs, bytes / 1e9, most_bytes / 1e9);
    return WB_OK;
}

static void take_memory(struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = bands->nominal->plan;
    const size_t runs = (size_t)bands->settings.runs, steps = (size_t)bands->nominal->n_steps;
    bands->points =
        wb_memory_take(&bands->memory, runs, (size_t)bands->n_dimensions * sizeof(double));
    bands->values = wb_memory_take(&bands->memory, runs, bands->stride * sizeof(double));
    bands->deviants = wb_memory_take(&bands->memory, runs, sizeof *bands->deviants);
    bands->steps = wb_memory_take(&bands->memory, steps, sizeof *bands->steps);
    for (size_t i = 0; i < steps; i++) {
        struct wb_harness_step_bands *const step = &bands->steps[i];
        step->forces = wb_memory_take(&bands->memory, (size_t)plan->n_items, sizeof *step->forces);
        step->branches =
            wb_memory_take(&bands->memory, (size_t)plan->n_branches, sizeof *step->branches);
    }
}

enum wb_status wb_harness_bands_create(struct wb_harness_bands **out,
                                       const struct wb_harness_result_set *nominal,
                                       const struct wb_harness_bands_settings *settings)
{
    struct wb_harness_bands *const bands = wb_memory_new(1, sizeof *bands);
    bands->nominal = nominal;
    bands->settings = *settings;
    bands->n_dimensions = count_dimensions(nominal->plan);
    bands->stride = step_offset(nominal->plan, nominal->n_steps);
    const enum wb_status status = check(bands);
    if (status != WB_OK) {
        wb_harness_bands_destroy(bands);
        return status;
    }
    take_memory(bands);
    wb_hypercube_fill(settings->seed, settings->runs, bands->n_dimensions, bands->points);
    *out = bands;
    return WB_OK;
}

void wb_harness_bands_destroy(struct wb_harness_bands *bands)
{
    if (!bands)
        return;
    wb_memory_release(&bands->memory);
    free(bands);
}
