#include "analysis/validation/validate_cycle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "validate"

/* Spacing of the points of the mean unloading, and of the model where there is no measurement. */
static const double step = 1.0 * WB_MM;

const double wb_validate_stiffer_by = 0.01;

struct wb_law wb_validate_stiffer(const struct wb_law *law, double ln_factor)
{
    const double factor = exp(ln_factor);
    struct wb_law scaled = *law;
    scaled.material.youngs_modulus *= factor;
    scaled.material.yield_stress *= factor;
    scaled.material.strength_coefficient *= factor;
    for (int i = 0; i < law->n_parts; i++)
        scaled.parts[i].modulus *= factor;
    scaled.saturation *= factor;
    for (int i = 0; i < law->n_backs; i++)
        scaled.backs[i].modulus *= factor;
    for (int i = 0; i < law->n_maxwell; i++)
        scaled.maxwell[i].modulus *= factor;
    return scaled;
}

/* One branch (loading or unloading) of a cycle, measured and computed. */
struct branch {
    int n, first; /* number of points, and index of the first in the path */
    int n_before; /* points of the cycle's data before this branch */
};

/* A sample's cycles as one path of the tip: from zero up and down, repeatedly. */
struct sample {
    int n_cycles;
    struct wb_cycle_data data[WB_VALIDATE_MOST_LOOPS + 1]; /* of each cycle */
    struct branch up[WB_VALIDATE_MOST_LOOPS + 1], back[WB_VALIDATE_MOST_LOOPS + 1];
    int end_of_first; /* number of the path's points up to the end of the first cycle at zero */
    struct wb_cycle_data path;
    double *tension; /* (path.n_points) N; NaN beyond the point that was reached */
    double zero;     /* N: computed tension at zero deflection */
    double *adapted; /* (end_of_first) N: tension of a law as stiff as this specimen, */
    double adapted_zero;
    double curvature;
    bool is_good; /* its first unloading was computed */
};

static void release_sample(struct sample *sample)
{
    for (int k = 0; k < sample->n_cycles; k++)
        wb_cycle_data_release(&sample->data[k]);
    free(sample->path.points);
    free(sample->tension);
    free(sample->adapted);
}

static void add_point(struct wb_cycle_data *path, double deflection, double t)
{
    path->points[path->n_points++] = (struct wb_cycle_point){.deflection = deflection, .t = t};
}

/* Time at which the line through two points reaches a deflection. */
static double time_at(const struct wb_cycle_point *a, const struct wb_cycle_point *b,
                      double deflection)
{
    return a->t + (b->t - a->t) * (deflection - a->deflection) / (b->deflection - a->deflection);
}

static struct branch add_branch(struct wb_cycle_data *path, const struct wb_cycle_data *data,
                                int begin, int end)
{
    const struct branch branch = {.n = end - begin, .first = path->n_points, .n_before = begin};
    for (int i = begin; i < end; i++)
        add_point(path, data->points[i].deflection, data->points[i].t);
    return branch;
}

/* Continues downwards to the rest; if the strand becomes slack before, the tip stays there. A wire
 * that is still loaded at zero deflection is bent back as far as the rest, which adds to the loss
 * in the next cycle. */
static void add_descent(struct wb_cycle_data *path)
{
    const double lowest = wb_cycle_model_rest(&path->info);
    const struct wb_cycle_point *const last = &path->points[path->n_points - 1];
    while (path->points[path->n_points - 1].deflection > lowest + step) {
        const double next = path->points[path->n_points - 1].deflection - step;
        add_point(path, next, time_at(last - 1, last, next));
    }
    add_point(path, lowest, time_at(last - 1, last, lowest));
}

static void make_path(struct sample *sample)
{
    struct wb_cycle_data *const path = &sample->path;
    size_t most = 1;
    path->info = sample->data[0].info;
    for (int k = 0; k < sample->n_cycles; k++) {
        const double descent = sample->data[k].top - wb_cycle_model_rest(&path->info);
        most += (size_t)sample->data[k].n_points + (size_t)(descent / step) + 5;
    }
    path->top = sample->data[0].top;
    path->arrival = sample->data[0].arrival;
    path->departure = sample->data[0].departure;
    path->n_held = sample->data[0].n_held;
    memcpy(path->held, sample->data[0].held, sizeof path->held);
    path->points = wb_memory_new(most, sizeof *path->points);
    sample->tension = wb_memory_new(most, sizeof *sample->tension);
    add_point(path, 0.0, time_at(sample->data[0].points, sample->data[0].points + 1, 0.0));
    for (int k = 0; k < sample->n_cycles; k++) {
        const struct wb_cycle_data *const data = &sample->data[k];
        sample->up[k] = add_branch(path, data, 0, data->n_loading);
        if (k == 0)
            path->n_loading = path->n_points; /* the model reaches the turn on its own */
        else
            add_point(path, data->top, data->arrival);
        if (k > 0 && data->n_held > 0)
            add_point(path, data->top, data->departure);
        sample->back[k] = add_branch(path, data, data->n_loading, data->n_points);
        if (sample->back[k].n > 0)
            add_descent(path);
        if (k == 0)
            sample->end_of_first = path->n_points;
    }
}

static bool is_finite(const struct sample *sample, int begin, int end)
{
    for (int i = begin; i < end; i++) {
        if (!isfinite(sample->tension[i]))
            return false;
    }
    return true;
}

/* Reads the later cycles in order until one is missing. */
static void read_later_cycles(struct sample *sample, const struct wb_dataset *dataset)
{
    while (sample->n_cycles <= WB_VALIDATE_MOST_LOOPS) {
        const struct wb_cycle_data_settings settings = {.cycle = sample->n_cycles + 1};
        struct wb_cycle_data *const data = &sample->data[sample->n_cycles];
        struct wb_reason why = {.text = ""};
        if (wb_cycle_data_take(data, dataset, &settings, &why) != WB_OK)
            return;
        sample->n_cycles++;
        if (data->n_points == data->n_loading)
            return;
    }
}

/* Scales the law to the specimen's stiffness: least squares over the points of its first loading,
 * to first order. The remaining error of the unloading is then that of the law, not of the
 * specimen's stiffness. */
static void find_stiffness(struct sample *sample, const double *stiffer)
{
    const struct wb_cycle_data *const data = &sample->data[0];
    const struct branch *const up = &sample->up[0];
    double squares = 0.0, products = 0.0;
    for (int i = 0; i < up->n; i++) {
        const int at = up->first + i;
        const double slope = (stiffer[at] - stiffer[0] - sample->tension[at] + sample->zero) /
                             wb_validate_stiffer_by;
        const double difference =
            data->points[i].tension - data->zero_tension - sample->tension[at] + sample->zero;
        squares += slope * slope;
        products += slope * difference;
    }
    const double ln_stiffness = products / squares;
    for (int i = 0; i < sample->end_of_first; i++)
        sample->adapted[i] = sample->tension[i] + ln_stiffness * (stiffer[i] - sample->tension[i]) /
                                                      wb_validate_stiffer_by;
    sample->adapted_zero = sample->adapted[0];
}

static enum wb_status adapt(struct sample *sample, const struct wb_law *law,
                            const struct wb_cycle_specimen *specimen,
                            const struct wb_cycle_model_settings *how)
{
    const struct wb_law stiffer = wb_validate_stiffer(law, wb_validate_stiffer_by);
    const size_t n = (size_t)sample->end_of_first;
    struct wb_cycle_data first = sample->path;
    struct wb_cycle_model *model;
    struct wb_cycle_run run;
    first.n_points = sample->end_of_first;
    WB_TRY(wb_cycle_model_create(&model, &first, &stiffer, how));
    double *const tension = wb_memory_new(n, sizeof *tension);
    const enum wb_status status =
        wb_cycle_model_run(model, &stiffer, specimen, tension, NULL, &run);
    wb_cycle_model_destroy(model);
    if (status == WB_OK && run.reached && sample->up[0].n > 0) {
        sample->adapted = wb_memory_new(n, sizeof *sample->adapted);
        find_stiffness(sample, tension);
    }
    free(tension);
    return status;
}

/* Returns WB_OK with sample->is_good false if the sample cannot be computed; `why` receives the
 * reason. */
static enum wb_status compute(struct sample *sample, const struct wb_law *law,
                              const struct wb_dataset *dataset,
                              const struct wb_validate_cycle_settings *settings,
                              struct wb_reason *why)
{
    const struct wb_cycle_model_settings how = {settings->n_elements, settings->n_fibres};
    const struct wb_test_info *const info = &dataset->info;
    const struct wb_cycle_specimen specimen = {
        .bow_angle = settings->straight ? 0.0 : 2.0 * wb_dataset_bow(info) / info->length};
    struct wb_cycle_model *model;
    struct wb_cycle_run run;

    sample->curvature = (double)NAN;
    const enum wb_status taken = wb_cycle_data_take(&sample->data[0], dataset, NULL, why);
    if (taken != WB_OK)
        return taken == WB_ERR_DATA ? WB_OK : taken;
    sample->n_cycles = 1;
    const bool has_unloading = sample->data[0].n_points > sample->data[0].n_loading;
    if (has_unloading)
        read_later_cycles(sample, dataset);
    make_path(sample);
    WB_TRY(wb_cycle_model_create(&model, &sample->path, law, &how));
    const enum wb_status status =
        wb_cycle_model_run(model, law, &specimen, sample->tension, NULL, &run);
    wb_cycle_model_destroy(model);
    WB_TRY(status);
    sample->curvature = run.clamp_curvature;
    sample->zero = sample->tension[0];
    sample->is_good = has_unloading && is_finite(sample, 0, sample->end_of_first);
    if (has_unloading && !sample->is_good)
        (void)wb_fail_to(why, WB_ERR_CONVERGENCE,
                         "wire '%s', sample %d: the beam does not converge over the first cycle",
                         info->wire, info->sample);
    return sample->is_good ? adapt(sample, law, &specimen, &how) : WB_OK;
}

/* --- the unloading --- */

/* Measured and computed tension at a deflection of the first unloading, between its points. */
static void at_deflection(const struct sample *sample, double deflection, double *measured,
                          double *computed, double *adapted)
{
    const struct branch *const back = &sample->back[0];
    const struct wb_cycle_data *const data = &sample->data[0];
    const struct wb_cycle_point *const points = data->points + data->n_loading;
    const double *const tension = sample->tension + back->first;
    int i = 1;
    while (i < back->n - 1 && points[i].deflection > deflection)
        i++;
    const double part =
        (points[i - 1].deflection - deflection) / (points[i - 1].deflection - points[i].deflection);
    *measured +=
        (1.0 - part) * points[i - 1].tension + part * points[i].tension - data->zero_tension;
    *computed += (1.0 - part) * tension[i - 1] + part * tension[i] - sample->zero;
    if (!sample->adapted)
        return;
    const double *const own = sample->adapted + back->first;
    *adapted += (1.0 - part) * own[i - 1] + part * own[i] - sample->adapted_zero;
}

/* Error of the unloading at a deflection with the law as stiff as each specimen: mean over the
 * specimens, and variance between them. */
static void find_remaining_error(const struct sample *samples, int n, double deflection,
                                 double *mean, double *variance)
{
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (int i = 0; i < n; i++) {
        double measured = 0.0, computed = 0.0, adapted = 0.0;
        if (!samples[i].adapted)
            continue;
        at_deflection(&samples[i], deflection, &measured, &computed, &adapted);
        sum += measured - adapted;
        squares += (measured - adapted) * (measured - adapted);
        count++;
    }
    *mean = sum / count;
    *variance = count > 1 ? fmax(squares - sum * sum / count, 0.0) / (count - 1) : (double)NAN;
}

/* Sum of the squared differences of a sample's points. */
static double squares_of(const struct sample *sample)
{
    const struct wb_cycle_data *const data = &sample->data[0];
    double sum = 0.0;
    for (int i = 0; i < sample->back[0].n; i++) {
        const double difference = data->points[data->n_loading + i].tension - data->zero_tension -
                                  (sample->tension[sample->back[0].first + i] - sample->zero);
        sum += difference * difference;
    }
    return sum;
}

static void find_mean(struct wb_validate_cycles *cycles, const struct sample *samples, int n,
                      double max_force)
{
    double high = (double)INFINITY, low = 0.0, squares = 0.0;
    long points = 0;
    for (int i = 0; i < n; i++) {
        const struct wb_cycle_data *const data = &samples[i].data[0];
        if (!samples[i].is_good)
            continue;
        high = fmin(high, data->points[data->n_loading].deflection);
        low = fmax(low, data->points[data->n_points - 1].deflection);
        squares += squares_of(&samples[i]);
        points += samples[i].back[0].n;
        cycles->n_samples++;
    }
    if (cycles->n_samples == 0)
        return;
    cycles->sample_rms = sqrt(squares / (double)points) / max_force;
    cycles->n = high >= low ? (int)((high - low) / step + 1e-9) + 1 : 0;
    const size_t size = (size_t)cycles->n;
    cycles->deflection = wb_memory_new(3 * size, sizeof *cycles->deflection);
    cycles->measured = cycles->deflection + size;
    cycles->computed = cycles->measured + size;
    double left = 0.0, scatter = 0.0;
    squares = 0.0;
    cycles->largest_error = 0.0;
    for (int k = 0; k < cycles->n; k++) {
        double *const measured = &cycles->measured[k], *const computed = &cycles->computed[k];
        double unused = 0.0, mean, variance;
        cycles->deflection[k] = high - k * step;
        for (int i = 0; i < n; i++) {
            if (samples[i].is_good)
                at_deflection(&samples[i], cycles->deflection[k], measured, computed, &unused);
        }
        find_remaining_error(samples, n, cycles->deflection[k], &mean, &variance);
        left += mean * mean;
        scatter += variance;
        *measured /= cycles->n_samples;
        *computed /= cycles->n_samples;
        const double error = fabs(*measured - *computed) / max_force;
        squares += error * error;
        cycles->largest_error = fmax(cycles->largest_error, error);
    }
    if (cycles->n == 0)
        return;
    cycles->rms = sqrt(squares / cycles->n);
    for (int i = 0; i < n; i++)
        cycles->n_adapted += samples[i].adapted != NULL;
    cycles->adapted_rms = sqrt(left / cycles->n) / max_force;
    cycles->adapted_scatter = sqrt(scatter / cycles->n) / max_force;
}

/* --- the residual deflection --- */

static double residual_of(const struct sample *sample, const double *tension, double zero)
{
    const struct wb_cycle_point *const points = sample->path.points;
    for (int i = sample->back[0].first; i + 1 < sample->end_of_first; i++) {
        if (tension[i] > zero && tension[i + 1] <= zero)
            return points[i].deflection - (points[i].deflection - points[i + 1].deflection) *
                                              (tension[i] - zero) / (tension[i] - tension[i + 1]);
    }
    return (double)NAN;
}

static void find_residual(struct wb_validate_cycles *cycles, const struct sample *samples, int n)
{
    double measured = 0.0, computed = 0.0, sum = 0.0, squares = 0.0;
    int found = 0, compared = 0;
    for (int i = 0; i < n; i++) {
        const struct sample *const s = &samples[i];
        const double is = s->data[0].residual_deflection;
        const double one = s->is_good ? residual_of(s, s->tension, s->zero) : (double)NAN;
        if (!isfinite(one) || !isfinite(is))
            continue;
        measured += is;
        computed += one;
        found++;
        const double own = s->adapted ? residual_of(s, s->adapted, s->adapted_zero) : (double)NAN;
        if (!isfinite(own))
            continue;
        sum += own - is;
        squares += (own - is) * (own - is);
        compared++;
    }
    if (compared > 1) {
        cycles->adapted_residual = sum / compared;
        cycles->residual_scatter = sqrt(fmax(squares - sum * sum / compared, 0.0) / (compared - 1));
        cycles->n_residuals = compared;
    }
    if (found > 0) {
        cycles->residual_measured = measured / found;
        cycles->residual_computed = computed / found;
    }
}

/* --- later cycles --- */

/* Work of the tension between two deflections of a branch; on unloading the recovered work. */
static double work_of(const struct wb_cycle_point *points, const double *tension, int n, double low,
                      double high)
{
    double sum = 0.0;
    for (int i = 0; i + 1 < n; i++) {
        const double x0 = points[i].deflection, x1 = points[i + 1].deflection;
        const double y0 = tension ? tension[i] : points[i].tension;
        const double y1 = tension ? tension[i + 1] : points[i + 1].tension;
        const double begin = fmax(fmin(x0, x1), low), end = fmin(fmax(x0, x1), high);
        if (end > begin)
            sum += (end - begin) * (y0 + (y1 - y0) * (0.5 * (begin + end) - x0) / (x1 - x0));
    }
    return sum;
}

static void find_loop(struct wb_validate_loop *loop, const struct sample *samples, int n)
{
    const int k = loop->cycle - 1;
    for (int i = 0; i < n; i++) {
        const struct sample *const sample = &samples[i];
        if (!sample->is_good || sample->n_cycles <= k || sample->back[k].n < 2)
            continue;
        const struct branch *const up = &sample->up[k], *const back = &sample->back[k];
        if (!is_finite(sample, up->first, back->first + back->n))
            continue;
        const struct wb_cycle_point *const p = sample->data[k].points;
        const struct wb_cycle_point *const q = p + back->n_before;
        const double low = fmax(p[0].deflection, q[back->n - 1].deflection);
        const double high = fmin(p[up->n - 1].deflection, q[0].deflection);
        loop->measured += work_of(p, NULL, up->n, low, high) - work_of(q, NULL, back->n, low, high);
        loop->computed += work_of(p, sample->tension + up->first, up->n, low, high) -
                          work_of(q, sample->tension + back->first, back->n, low, high);
        loop->n_samples++;
    }
    loop->measured /= loop->n_samples;
    loop->computed /= loop->n_samples;
}

static void find_loops(struct wb_validate_cycles *cycles, const struct sample *samples, int n)
{
    for (int cycle = 2; cycles->n_loops < WB_VALIDATE_MOST_LOOPS; cycle++) {
        struct wb_validate_loop loop = {.cycle = cycle};
        find_loop(&loop, samples, n);
        if (loop.n_samples == 0)
            return;
        cycles->loops[cycles->n_loops++] = loop;
    }
}

enum wb_status wb_validate_cycles_run(struct wb_validate_cycles *cycles, const struct wb_law *law,
                                      const struct wb_dataset *const *datasets, int n,
                                      const struct wb_validate_cycle_settings *settings)
{
    const double none = (double)NAN;
    *cycles = (struct wb_validate_cycles){.clamp_curvature = none,
                                          .rms = none,
                                          .largest_error = none,
                                          .sample_rms = none,
                                          .residual_measured = none,
                                          .residual_computed = none,
                                          .adapted_rms = none,
                                          .adapted_scatter = none,
                                          .adapted_residual = none,
                                          .residual_scatter = none};
    struct sample *const samples = wb_memory_new((size_t)n, sizeof *samples);
    enum wb_status status = WB_OK;
    for (int i = 0; status == WB_OK && i < n; i++) {
        status = compute(&samples[i], law, datasets[i], settings, &cycles->why);
        cycles->clamp_curvature = fmax(cycles->clamp_curvature, samples[i].curvature);
    }
    if (status == WB_OK) {
        find_mean(cycles, samples, n, settings->max_force);
        find_residual(cycles, samples, n);
        find_loops(cycles, samples, n);
    }
    for (int i = 0; i < n; i++)
        release_sample(&samples[i]);
    free(samples);
    if (status != WB_OK)
        wb_validate_cycles_release(cycles);
    return status;
}

void wb_validate_cycles_release(struct wb_validate_cycles *cycles)
{
    free(cycles->deflection);
    *cycles = (struct wb_validate_cycles){.n = 0};
}
