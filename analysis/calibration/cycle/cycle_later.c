#include "analysis/calibration/cycle/cycle_later.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/stops.h"
#include "base/memory.h"
#include "base/units.h"

/* Step between the compared deflections; below this tension the strand is nearly slack. */
static const double step = 1.0 * WB_MM, smallest_tension = 2.5e-3;

/* Means of the rows of a bin. */
struct bin {
    double deflection, tension, t;
    int n;
};

int wb_cycle_later_count(const struct wb_dataset *dataset)
{
    int n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (dataset->rows[i].cycle > n)
            n = dataset->rows[i].cycle;
    }
    return n;
}

/* Also the mean time. */
static double largest_deflection(const struct wb_dataset *dataset, int cycle, double *t)
{
    double largest = 0.0;
    *t = (double)NAN;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle == cycle && row->phase != WB_PHASE_SLACK && row->deflection > largest) {
            largest = row->deflection;
            *t = row->t;
        }
    }
    return largest;
}

/* Deflection at which the unloading of a cycle ends or the strand becomes slack: of the lowest row
 * with enough tension, and not below the rest, where readings are noise. */
static double lowest_deflection(const struct wb_dataset *dataset, int cycle, double *t)
{
    double lowest = largest_deflection(dataset, cycle, t);
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle == cycle && row->phase == WB_PHASE_UNLOAD && row->tension > 0.0 &&
            row->deflection < lowest) {
            lowest = row->deflection;
            *t = row->t;
        }
    }
    return isfinite(dataset->info.rest_level) ? fmax(lowest, dataset->info.rest_level) : lowest;
}

/* Appends the points of one branch of a cycle in the order of the test. */
static void add_way(struct wb_cycle_later *later, const struct wb_dataset *dataset, int cycle,
                    bool is_unloading, struct bin *bins, int n_bins)
{
    struct wb_stop stop;
    const bool has_dwell = wb_stops_at_turn(dataset, cycle, &stop);
    memset(bins, 0, (size_t)n_bins * sizeof *bins);
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        const enum wb_phase phase = is_unloading ? WB_PHASE_UNLOAD : WB_PHASE_LOAD;
        const int k = (int)(row->deflection / step);
        if (row->cycle != cycle || row->phase != phase || !(row->tension > smallest_tension) ||
            !(row->deflection > 0.0) || k >= n_bins ||
            (has_dwell && row->t > stop.arrival && row->t < stop.departure))
            continue;
        bins[k].deflection += row->deflection;
        bins[k].tension += row->tension;
        bins[k].t += row->t;
        bins[k].n++;
    }
    for (int i = 0; i < n_bins; i++) {
        const struct bin *const bin = &bins[is_unloading ? n_bins - 1 - i : i];
        if (bin->n > 0)
            later->points[later->n++] = (struct wb_cycle_later_point){
                .cycle = cycle,
                .is_unloading = is_unloading,
                .deflection = bin->deflection / bin->n,
                .measured = bin->tension / bin->n,
                .t = bin->t / bin->n,
                .computed = (double)NAN,
            };
    }
}

static void push(struct wb_cycle_data *path, double deflection, double t)
{
    path->points[path->n_points++] = (struct wb_cycle_point){.deflection = deflection, .t = t};
}

/* All deflections of the test in order, and which of them are points of later cycles. */
static void make_path(struct wb_cycle_data *path, int *index, const struct wb_cycle_later *later,
                      const struct wb_dataset *dataset, const struct wb_cycle_data *data)
{
    path->n_points = 0;
    for (int i = 0; i < data->n_points; i++) {
        push(path, data->points[i].deflection, data->points[i].t);
        if (i == data->n_loading - 1)
            push(path, data->top, data->arrival);
        if (i == data->n_loading - 1 && data->n_held > 0)
            push(path, data->top, data->departure);
    }
    double t, deflection;
    for (int i = 0; i < later->n; i++) {
        const struct wb_cycle_later_point *const p = &later->points[i];
        /* Both turns are included, because the mean of a bin does not reach them and a loop that
         * turns too early is too small. */
        if (i == 0 || p->cycle != later->points[i - 1].cycle)
            deflection = lowest_deflection(dataset, p->cycle - 1, &t);
        else if (p->is_unloading && !later->points[i - 1].is_unloading)
            deflection = largest_deflection(dataset, p->cycle, &t);
        else
            deflection = (double)NAN;
        struct wb_stop stop;
        const bool is_top = i > 0 && p->is_unloading && !later->points[i - 1].is_unloading;
        const bool has_dwell = is_top && wb_stops_at_turn(dataset, p->cycle, &stop);
        if (has_dwell)
            push(path, deflection, stop.arrival);
        if (isfinite(deflection))
            push(path, deflection, has_dwell ? stop.departure : t);
        index[i] = path->n_points;
        push(path, p->deflection, p->t);
    }
    path->n_loading = path->n_points;
    path->n_places = 0;
}

static void judge(struct wb_cycle_later *later, double max_force)
{
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i < later->n; i++) {
        const struct wb_cycle_later_point *const p = &later->points[i];
        const struct wb_cycle_later_point *const before = i > 0 ? p - 1 : NULL;
        if (!isfinite(p->computed))
            continue;
        sum += (p->computed - p->measured) * (p->computed - p->measured);
        n++;
        if (!before || before->cycle != p->cycle)
            continue;
        const double way = 0.5 * (p->deflection - before->deflection);
        later->measured_energy += way * (p->measured + before->measured);
        later->computed_energy += way * (p->computed + before->computed);
    }
    later->rms = n > 0 ? sqrt(sum / n) / max_force : (double)NAN;
    later->measured_energy /= later->n_cycles - 1;
    later->computed_energy /= later->n_cycles - 1;
}

static enum wb_status predict(struct wb_cycle_later *later, const struct wb_dataset *dataset,
                              const struct wb_cycle_data *data, const struct wb_cycle_fit *fit,
                              struct bin *bins, int n_bins)
{
    for (int cycle = 2; cycle <= later->n_cycles; cycle++) {
        add_way(later, dataset, cycle, false, bins, n_bins);
        add_way(later, dataset, cycle, true, bins, n_bins);
    }
    struct wb_cycle_data path = *data;
    const size_t most = (size_t)(data->n_points + later->n + 3 * later->n_cycles + 3);
    path.points = wb_memory_new(most, sizeof *path.points);
    double *const tension = wb_memory_new(most, sizeof *tension);
    int *const index = wb_memory_new(most, sizeof *index);
    const struct wb_cycle_specimen specimen = {fit->bow_angle, fit->level, fit->uneven_angle};
    const struct wb_cycle_model_settings how = {0, 0};
    struct wb_cycle_model *model = NULL;
    struct wb_cycle_run run;
    make_path(&path, index, later, dataset, data);
    enum wb_status status = wb_cycle_model_create(&model, &path, &fit->law, &how);
    if (status == WB_OK)
        status = wb_cycle_model_run(model, &fit->law, &specimen, tension, NULL, &run);
    for (int i = 0; status == WB_OK && i < later->n; i++)
        later->points[i].computed = tension[index[i]];
    wb_cycle_model_destroy(model);
    free(path.points);
    free(tension);
    free(index);
    return status;
}

enum wb_status wb_cycle_later_predict(struct wb_cycle_later *later,
                                      const struct wb_dataset *dataset,
                                      const struct wb_cycle_data *data,
                                      const struct wb_cycle_fit *fit)
{
    *later = (struct wb_cycle_later){.sample = dataset->info.sample,
                                     .n_cycles = wb_cycle_later_count(dataset)};
    if (later->n_cycles < 2 || data->n_loading == data->n_points)
        return WB_OK;
    const int n_bins = (int)(2.0 * data->top / step) + 2;
    struct bin *const bins = wb_memory_new((size_t)n_bins, sizeof *bins);
    later->points = wb_memory_new((size_t)(2 * n_bins * later->n_cycles), sizeof *later->points);
    const enum wb_status status = predict(later, dataset, data, fit, bins, n_bins);
    free(bins);
    if (status == WB_OK)
        judge(later, data->max_force);
    else
        wb_cycle_later_release(later);
    return status;
}

void wb_cycle_later_release(struct wb_cycle_later *later)
{
    free(later->points);
    later->points = NULL;
    later->n = 0;
}
