#include "analysis/series_results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_fit.h>

#include "analysis/align/align.h"
#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/dataset/holds.h"
#include "analysis/plot/figure.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/units.h"
#include "daq/protocol/average.h"

#define WB_LOG_DOMAIN "series"

#define WIDTH 460.0 /* points */
#define HEIGHT 320.0
#define PNG_SCALE 2.5
/* Deflection over length up to which the curve is taken for straight, as for the calibration's E.
 */
#define ELASTIC_ZONE 0.05
#define COLUMN 16 /* characters, of the table */

static const struct {
    const char *name, *unit, *key;
    double scale;
    int decimals;
} quantities[] = {
    [WB_SERIES_PEAK_FORCE] = {"peak force", "mN", "peak_force_mN", WB_MN, 2},
    [WB_SERIES_STIFFNESS] = {"stiffness", "mN/mm", "initial_stiffness_mN_per_mm", WB_MN / WB_MM, 3},
    [WB_SERIES_RESIDUAL] = {"residual", "mm", "residual_deflection_mm", WB_MM, 2},
    [WB_SERIES_LOOP] = {"loop area", "mJ", "loop_area_mJ", WB_MJ, 3},
};

/* --- of one test --- */

/* Least-squares slope of the loading's first points, N/m. */
static double find_stiffness(const struct wb_cycle_data *data)
{
    double level, slope, c00, c01, c11, squares;
    const size_t stride = sizeof *data->points / sizeof(double);
    int n = 0;
    while (n < data->n_loading && data->points[n].deflection <= ELASTIC_ZONE * data->info.length)
        n++;
    if (n < 3)
        return (double)NAN;
    gsl_fit_linear(&data->points[0].deflection, stride, &data->points[0].tension, stride, (size_t)n,
                   &level, &slope, &c00, &c01, &c11, &squares);
    return slope;
}

bool wb_series_results_shows(const struct wb_row *row)
{
    return row->cycle == 1 && row->phase != WB_PHASE_SLACK && row->deflection >= 0.0;
}

static double find_peak(const struct wb_dataset *dataset)
{
    double peak = (double)NAN;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (wb_series_results_shows(&dataset->rows[i]))
            peak = fmax(peak, dataset->rows[i].force);
    }
    return peak;
}

static void find_values(struct wb_series_test *test)
{
    struct wb_cycle_data data;
    struct wb_reason why = {.text = ""};
    const struct wb_json *const timing =
        wb_json_get(wb_json_get(test->dataset.document, "checks"), "timing");
    double loop_mJ;
    test->values[WB_SERIES_PEAK_FORCE] = find_peak(&test->dataset);
    if (wb_cycle_data_take(&data, &test->dataset, NULL, &why) != WB_OK)
        return;
    test->values[WB_SERIES_STIFFNESS] = find_stiffness(&data);
    test->values[WB_SERIES_RESIDUAL] = data.residual_deflection;
    /* Without unloading the area is not one of a loop. */
    if (data.n_loading < data.n_points && wb_json_get_number(timing, "loop_area_mJ", &loop_mJ))
        test->values[WB_SERIES_LOOP] = loop_mJ * WB_MJ;
    wb_cycle_data_release(&data);
}

struct wb_series_test *wb_series_results_add(struct wb_series_results *results, const char *path,
                                             int number)
{
    struct wb_align_settings settings;
    struct wb_reason why = {.text = ""};
    results->tests =
        wb_memory_resize(results->tests, (size_t)results->n + 1, sizeof *results->tests);
    struct wb_series_test *const test = &results->tests[results->n++];
    memset(test, 0, sizeof *test);
    snprintf(test->name, sizeof test->name, "%s", wb_file_name(path));
    test->number = number;
    for (int k = 0; k < WB_SERIES_QUANTITIES; k++)
        test->values[k] = (double)NAN;
    wb_align_default_settings(&settings);
    test->is_usable = wb_align_run(&test->dataset, path, &settings, &why) == WB_OK;
    snprintf(test->problem, sizeof test->problem, "%.319s", why.text);
    if (test->is_usable) {
        test->sample = test->dataset.info.sample;
        find_values(test);
    }
    return test;
}

void wb_series_results_release(struct wb_series_results *results)
{
    for (int i = 0; i < results->n; i++) {
        if (results->tests[i].is_usable)
            wb_dataset_release(&results->tests[i].dataset);
    }
    free(results->tests);
    memset(results, 0, sizeof *results);
}

/* --- of all of them --- */

/* Over the tests that count and have the quantity. */
static struct wb_average average_of(const struct wb_series_results *results,
                                    enum wb_series_quantity quantity)
{
    struct wb_average average = {0};
    for (int i = 0; i < results->n; i++) {
        const double value = results->tests[i].values[quantity];
        if (!results->tests[i].excluded.is_excluded && isfinite(value))
            wb_average_add(&average, value);
    }
    return average;
}

/* NaN with fewer than two. */
static double deviation_of(const struct wb_average *average)
{
    return average->n > 1 ? wb_average_deviation(average) : (double)NAN;
}

static void append_value(struct wb_text *text, double value, int width, int decimals)
{
    if (isfinite(value))
        wb_text_append(text, "%*.*f", width, decimals, value);
    else
        wb_text_append(text, "%*s", width, "--");
}

static void append_heading(struct wb_text *text)
{
    wb_text_append(text, "%5s%8s", "test", "sample");
    for (int k = 0; k < WB_SERIES_QUANTITIES; k++)
        wb_text_append(text, "%*s", COLUMN, quantities[k].name);
    wb_text_append(text, "\n%13s", "");
    for (int k = 0; k < WB_SERIES_QUANTITIES; k++)
        wb_text_append(text, "%*s", COLUMN, quantities[k].unit);
    wb_text_append(text, "\n");
}

static void append_test(struct wb_text *text, const struct wb_series_test *test)
{
    wb_text_append(text, "%5d%8d", test->number, test->sample);
    for (int k = 0; k < WB_SERIES_QUANTITIES; k++)
        append_value(text, test->values[k] / quantities[k].scale, COLUMN, quantities[k].decimals);
    if (test->excluded.is_excluded)
        wb_text_append(text, "  excluded: %s", test->excluded.reason);
    else if (!test->is_usable)
        wb_text_append(text, "  %s", test->problem);
    double held;
    if (test->is_usable && wb_holds_of_bent_wire(&test->dataset, &held) > 0)
        wb_text_append(text, "  held for %.0f s", held);
    wb_text_append(text, "\n");
}

void wb_series_results_append(const struct wb_series_results *results, struct wb_text *text)
{
    static const char *const labels[] = {"mean", "s", "s, %", "tests"};
    append_heading(text);
    for (int i = 0; i < results->n; i++)
        append_test(text, &results->tests[i]);
    for (int row = 0; row < 4; row++) {
        wb_text_append(text, "%-13s", labels[row]);
        for (int k = 0; k < WB_SERIES_QUANTITIES; k++) {
            const struct wb_average average = average_of(results, (enum wb_series_quantity)k);
            const double s = deviation_of(&average);
            const double mean = average.n > 0 ? average.mean : (double)NAN;
            const double values[] = {mean / quantities[k].scale, s / quantities[k].scale,
                                     s / fabs(mean) / WB_PERCENT, (double)average.n};
            const int decimals[] = {quantities[k].decimals, quantities[k].decimals + 1, 1, 0};
            append_value(text, values[row], COLUMN, decimals[row]);
        }
        wb_text_append(text, "\n");
    }
}

void wb_series_results_describe(const struct wb_series_results *results, struct wb_json *object)
{
    struct wb_json *const tests = wb_json_set_array(object, "tests");
    for (int i = 0; i < results->n; i++) {
        const struct wb_series_test *const test = &results->tests[i];
        struct wb_json *const entry = wb_json_append_object(tests);
        wb_json_set_text(entry, "recording", test->name);
        wb_json_set_integer(entry, "number", test->number);
        wb_json_set_integer(entry, "sample", test->sample);
        wb_json_set_text(entry, "problem", test->is_usable ? NULL : test->problem);
        for (int k = 0; k < WB_SERIES_QUANTITIES; k++)
            wb_json_set_number(entry, quantities[k].key, test->values[k] / quantities[k].scale);
        if (test->excluded.is_excluded)
            wb_index_exclusion_set_json(&test->excluded, entry);
    }
    struct wb_json *const statistics = wb_json_set_object(object, "statistics");
    for (int k = 0; k < WB_SERIES_QUANTITIES; k++) {
        const struct wb_average average = average_of(results, (enum wb_series_quantity)k);
        struct wb_json *const entry = wb_json_set_object(statistics, quantities[k].key);
        wb_json_set_integer(entry, "tests", average.n);
        wb_json_set_number(entry, "mean",
                           average.n > 0 ? average.mean / quantities[k].scale : (double)NAN);
        wb_json_set_number(entry, "standard_deviation",
                           deviation_of(&average) / quantities[k].scale);
    }
}

/* --- the figure --- */

static void add_curve(struct wb_panel *panel, const struct wb_series_test *test, int index,
                      double *x, double *y)
{
    const bool is_excluded = test->excluded.is_excluded;
    struct wb_figure_style style = {.colour = wb_palette_wire(index),
                                    .width = 1.1,
                                    .dash = index / 6 % 2 ? WB_DASH_DASHED : WB_DASH_SOLID};
    const double longest = wb_dataset_gap(&test->dataset);
    char label[64];
    double last = (double)NAN;
    size_t n = 0;
    for (size_t i = 0; i < test->dataset.n_rows; i++) {
        const struct wb_row *const row = &test->dataset.rows[i];
        const bool is_shown = wb_series_results_shows(row) && !(row->t - last > longest);
        last = row->t;
        x[n] = is_shown ? row->deflection / WB_MM : (double)NAN;
        y[n++] = is_shown ? row->force / WB_MN : (double)NAN;
    }
    if (is_excluded)
        style = (struct wb_figure_style){
            .colour = wb_palette_grey(), .width = 0.7, .dash = WB_DASH_DOTTED};
    snprintf(label, sizeof label, "test %d, sample %d%s", test->number, test->sample,
             is_excluded ? ", excluded" : "");
    wb_figure_add_line(panel, label, n, x, y, &style);
}

static size_t largest_rows(const struct wb_series_results *results)
{
    size_t most = 0;
    for (int i = 0; i < results->n; i++) {
        const struct wb_series_test *const test = &results->tests[i];
        if (test->is_usable && test->dataset.n_rows > most)
            most = test->dataset.n_rows;
    }
    return most;
}

/* Wire, length, and how many tests count; where the data come from. */
static void describe_figure(struct wb_figure *figure, struct wb_panel *panel,
                            const struct wb_series_results *results, const char *series)
{
    struct wb_text title = {0}, footer = {0};
    const struct wb_dataset *dataset = NULL;
    const struct wb_average peak = average_of(results, WB_SERIES_PEAK_FORCE);
    for (int i = 0; i < results->n; i++)
        dataset = results->tests[i].is_usable ? &results->tests[i].dataset : dataset;
    wb_text_append_escaped(&title, dataset->info.wire);
    wb_text_append(&title, ", <i>L</i> = %g mm", dataset->info.length / WB_MM);
    if (peak.n > 1)
        wb_text_append(&title, ": peak %.1f mN, <i>s</i> = %.1f mN, <i>n</i> = %d",
                       peak.mean / WB_MN, deviation_of(&peak) / WB_MN, (int)peak.n);
    wb_figure_set_title(panel, wb_text_string(&title));
    wb_text_append_escaped(&footer, series);
    wb_text_append(&footer, ", first cycles, measured%s",
                   dataset->info.is_virtual ? " on a virtual rig" : "");
    wb_figure_set_footer(figure, wb_text_string(&footer));
    wb_text_release(&title);
    wb_text_release(&footer);
}

enum wb_status wb_series_results_draw(const struct wb_series_results *results, const char *series,
                                      const char *path)
{
    struct wb_figure *figure;
    const size_t most = largest_rows(results);
    if (most == 0)
        return wb_fail(WB_ERR_DATA, "no test of the series can be drawn");
    double *const x = wb_memory_new(2 * most, sizeof *x);
    enum wb_status status = wb_figure_create(&figure, "series", WIDTH, HEIGHT);
    if (status == WB_OK) {
        struct wb_panel *const panel = wb_figure_add_panel(figure);
        wb_figure_set_axes(panel, "Deflection (mm)",
                           "Force above its value at zero deflection (mN)");
        describe_figure(figure, panel, results, series);
        for (int i = 0; i < results->n; i++) {
            if (results->tests[i].is_usable)
                add_curve(panel, &results->tests[i], i, x, x + most);
        }
        status = wb_figure_write_file(figure, PNG_SCALE, path);
        wb_figure_destroy(figure);
    }
    free(x);
    return status;
}
