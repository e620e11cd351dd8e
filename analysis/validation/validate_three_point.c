#include "analysis/validation/validate_three_point.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/three_point/three_point_model.h"
#include "analysis/calibration/three_point/three_point_place.h"
#include "analysis/dataset/errors.h"
#include "analysis/dataset/fit.h"
#include "analysis/validation/validate.h"
#include "analysis/validation/validate_tables.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "validate"

enum {
    GRID = WB_VALIDATE_THREE_POINT_GRID,
    LAST_POINTS = 3 /* points of the unloading whose line is extrapolated to zero force */
};

/* Factor as in validate.c. */
static const double beyond = 1.1;

/* Common input of the runs of one group. */
struct group {
    struct wb_validate_three_point *result;
    const struct wb_law *law;
    const struct wb_three_point_calibrate_settings *settings;
    struct wb_three_point_model *model;
    double deepest; /* largest deflection of all tests, m */
};

/* --- runs of a law on a bench --- */

/* Means over the tests, each with its own bow, at the deflections of the loading. */
struct curve {
    double force[GRID], stiffness[GRID]; /* N, N/m of travel */
    double force_as_read[GRID]; /* each test begins at the first contact that the readings show */
    double largest_curvature;   /* 1/m */
    bool reached;               /* else the arrays are not set */
};

static double bend(const struct group *g, const struct wb_validate_three_point_test *test)
{
    return wb_three_point_model_curvature(&g->result->info, test->bow);
}

static enum wb_status create(const struct group *g, const struct wb_three_point_bench *bench,
                             const struct wb_law *law, struct wb_three_point_model **model)
{
    return wb_three_point_model_create(model, &g->result->info, bench, law,
                                       g->settings->fit.n_elements);
}

static enum wb_status compute(const struct group *g, struct wb_three_point_model *model,
                              const struct wb_law *law, struct curve *curve)
{
    const struct wb_validate_three_point *const r = g->result;
    struct wb_three_point_run run = {.reached = false};
    double bent = (double)NAN; /* not computed yet */
    *curve = (struct curve){.reached = true};
    for (int i = 0; i < r->n_tests && curve->reached; i++) {
        const struct wb_validate_three_point_test *const test = &r->tests[i];
        if (!test->is_used)
            continue;
        if (bend(g, test) != bent) {
            bent = bend(g, test);
            WB_TRY(wb_three_point_model_run(model, law, bent, g->deepest, false, &run));
        }
        curve->reached = run.reached;
        curve->largest_curvature = fmax(curve->largest_curvature, run.largest_curvature);
        const double shift = test->first_contact - test->data.first_contact;
        for (int k = 0; k < GRID && run.reached; k++) {
            const double at = r->loading.deflection[k];
            curve->force[k] += wb_three_point_model_force(model, at, false) / r->n_used;
            curve->stiffness[k] += wb_three_point_model_stiffness(model, at, false) / r->n_used;
            curve->force_as_read[k] +=
                wb_three_point_model_force(model, at + shift, false) / r->n_used;
        }
    }
    return WB_OK;
}

/* Computes with a bench or a law other than the group's. */
static enum wb_status compute_other(const struct group *g, const struct wb_three_point_bench *bench,
                                    const struct wb_law *law, struct curve *curve)
{
    struct wb_three_point_model *model;
    WB_TRY(create(g, bench, law, &model));
    const enum wb_status status = compute(g, model, law, curve);
    wb_three_point_model_destroy(model);
    return status;
}

/* --- first contacts and bows --- */

static enum wb_status find_places(const struct group *g, struct wb_reason *why)
{
    struct wb_validate_three_point *const r = g->result;
    for (int i = 0; i < r->n_tests; i++) {
        struct wb_validate_three_point_test *const test = &r->tests[i];
        const struct wb_three_point_data *const data = &test->data;
        struct wb_three_point_place place;
        struct wb_three_point_run run;
        double middle, deviation;
        if (!test->is_used)
            continue;
        WB_TRY(wb_three_point_place_find(&place, g->model, g->law, data, g->deepest,
                                         &g->settings->fit, &run));
        if (!run.reached)
            return wb_fail_to(why, WB_ERR_CONVERGENCE,
                              "wire '%s', span %g mm: the model reaches %.3g of %.3g mm (%s): use "
                              "less of the test (usable_travel_mm, --usable-mm)",
                              r->info.wire, r->info.length / WB_MM, run.travel / WB_MM,
                              g->deepest / WB_MM, wb_three_point_bending_end_name(run.end));
        wb_three_point_place_bow(&data->info, &g->settings->fit, &middle, &deviation);
        test->is_bow_searched = deviation > 0.0;
        test->first_contact = place.first_contact;
        test->bow = place.bow;
        const int n = wb_three_point_data_count_loading(data);
        double sum = 0.0;
        for (int k = 0; k < n; k++) {
            const struct wb_three_point_point *const point = &data->points[k];
            const double force =
                wb_three_point_model_force(g->model, point->travel - test->first_contact, false);
            sum += pow(force - point->force, 2);
        }
        test->rms = sqrt(sum / n) / data->max_force;
    }
    return WB_OK;
}

/* --- the loading --- */

/* Finds the deflections that all tests have, and the mean measured loading. */
static enum wb_status find_loading(struct wb_validate_three_point *r, struct wb_reason *why)
{
    struct wb_validate_three_point_branch *const branch = &r->loading;
    double from = 0.0, to = HUGE_VAL, squares = 0.0;
    for (int i = 0; i < r->n_tests; i++) {
        const struct wb_validate_three_point_test *const test = &r->tests[i];
        const struct wb_three_point_point *const points = test->data.points;
        if (!test->is_used)
            continue;
        from = fmax(from, points[0].travel - test->first_contact);
        to = fmin(to, points[wb_three_point_data_count_loading(&test->data) - 1].travel -
                          test->first_contact);
    }
    if (!(to > from))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', span %g mm: the tests have no deflections in common: "
                          "validate them separately",
                          r->info.wire, r->info.length / WB_MM);
    branch->n = GRID;
    for (int k = 0; k < GRID; k++) {
        double sum = 0.0, spread = 0.0;
        branch->deflection[k] = from + (to - from) * k / (GRID - 1);
        for (int pass = 0; pass < 2; pass++) {
            for (int i = 0; i < r->n_tests; i++) {
                const struct wb_validate_three_point_test *const test = &r->tests[i];
                if (!test->is_used)
                    continue;
                const double force = wb_three_point_data_force(
                    &test->data, branch->deflection[k] + test->first_contact, false);
                if (pass == 0)
                    sum += force / r->n_used;
                else
                    spread += pow(force - sum, 2);
            }
        }
        branch->measured[k] = sum;
        branch->deviation[k] = r->n_used > 1 ? sqrt(spread / (r->n_used - 1)) : (double)NAN;
        squares += spread / fmax(1.0, r->n_used - 1.0) / GRID;
        r->max_force = fmax(r->max_force, sum);
    }
    r->scatter_rms = r->n_used > 1 ? sqrt(squares) / r->max_force : (double)NAN;
    return WB_OK;
}

static void compute_errors(struct wb_validate_three_point_branch *branch, double max_force)
{
    double error[GRID];
    wb_errors_curve(branch->n, branch->measured, branch->computed, max_force, error);
    branch->rms = wb_errors_rms(branch->n, error);
    branch->largest_error = wb_errors_largest(branch->n, error);
}

static double rms_of(const struct wb_validate_three_point *r, const double *force)
{
    double error[GRID];
    wb_errors_curve(GRID, r->loading.measured, force, r->max_force, error);
    return wb_errors_rms(GRID, error);
}

static enum wb_status find_elastic(const struct group *g)
{
    struct wb_validate_three_point *const r = g->result;
    const struct wb_law_part part = {g->law->material.youngs_modulus, (double)INFINITY};
    struct wb_law elastic;
    struct curve curve;
    wb_law_init_parallel(&elastic, &part, 1, 0.0, g->law->material.poissons_ratio);
    r->elastic_rms = (double)NAN;
    WB_TRY(compute_other(g, &r->bench, &elastic, &curve));
    if (!curve.reached)
        return WB_OK;
    memcpy(r->elastic, curve.force, sizeof r->elastic);
    r->elastic_rms = rms_of(r, curve.force);
    return WB_OK;
}

static enum wb_status vary_bench(const struct group *g)
{
    struct wb_validate_three_point *const r = g->result;
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        struct wb_three_point_bench bench = r->bench;
        double *const number = i < 2 ? &bench.friction : &bench.nose_radius;
        struct curve curve;
        r->bench_rms[i] = (double)NAN;
        if (*number == r->ends[i].value)
            continue;
        *number = r->ends[i].value;
        WB_TRY(compute_other(g, &bench, g->law, &curve));
        if (curve.reached)
            r->bench_rms[i] = rms_of(r, curve.force);
    }
    return WB_OK;
}

/* --- the unloading --- */

static double zero_of(const struct wb_validate_three_point_test *test)
{
    const int first = test->data.n_points - LAST_POINTS;
    double x[LAST_POINTS], y[LAST_POINTS];
    struct wb_fit_line line;
    if (first <= wb_three_point_data_count_loading(&test->data))
        return (double)NAN;
    for (int i = 0; i < LAST_POINTS; i++) {
        x[i] = test->data.points[first + i].travel - test->first_contact;
        y[i] = test->data.points[first + i].force;
    }
    return wb_fit_line(x, y, LAST_POINTS, &line) && line.slope > 0.0 ? -line.value / line.slope
                                                                     : (double)NAN;
}

/* Computes a test separately, up to its own turn and back. */
static enum wb_status run_unloading(const struct group *g,
                                    struct wb_validate_three_point_test *test, bool *reached)
{
    const struct wb_three_point_data *const data = &test->data;
    const double top = data->usable - test->first_contact;
    struct wb_three_point_run run;
    WB_TRY(wb_three_point_model_run(g->model, g->law, bend(g, test), g->deepest, false, &run));
    if (!run.reached)
        return WB_OK;
    const double force = wb_three_point_model_force(g->model, top, false);
    WB_TRY(wb_three_point_model_run(g->model, g->law, bend(g, test),
                                    top - g->result->bench.compliance * force, true, &run));
    *reached = run.reached;
    if (!run.reached)
        return WB_OK;
    const int loading = wb_three_point_data_count_loading(data);
    double sum = 0.0;
    for (int i = loading; i < data->n_points; i++)
        sum += pow(wb_three_point_model_force(g->model,
                                              data->points[i].travel - test->first_contact, true) -
                       data->points[i].force,
                   2);
    test->unloading_rms = sqrt(sum / (data->n_points - loading)) / data->max_force;
    test->residual_measured = zero_of(test);
    test->residual_computed = run.residual;
    return WB_OK;
}

/* Deflections that all unloadings have. */
static void find_common(const struct wb_validate_three_point *r, double *low, double *high)
{
    *low = 0.0;
    *high = HUGE_VAL;
    for (int i = 0; i < r->n_tests; i++) {
        const struct wb_validate_three_point_test *const test = &r->tests[i];
        const struct wb_three_point_data *const data = &test->data;
        if (!test->is_used || !data->has_unloading)
            continue;
        *high = fmin(*high, data->points[wb_three_point_data_count_loading(data)].travel -
                                test->first_contact);
        *low = fmax(*low, data->points[data->n_points - 1].travel - test->first_contact);
    }
}

static enum wb_status validate_unloading(const struct group *g)
{
    struct wb_validate_three_point *const r = g->result;
    struct wb_validate_three_point_branch *const branch = &r->unloading;
    double low, high, squares = 0.0, measured = 0.0, computed = 0.0;
    long n_points = 0;
    int n_left = 0;
    find_common(r, &low, &high);
    for (int k = 0; k < GRID; k++)
        branch->deflection[k] = high - (high - low) * k / (GRID - 1);
    for (int i = 0; i < r->n_tests; i++) {
        struct wb_validate_three_point_test *const test = &r->tests[i];
        bool reached = false;
        test->unloading_rms = test->residual_measured = test->residual_computed = (double)NAN;
        if (!test->is_used || !test->data.has_unloading)
            continue;
        WB_TRY(run_unloading(g, test, &reached));
        if (!reached)
            continue;
        const int n = test->data.n_points - wb_three_point_data_count_loading(&test->data);
        r->n_unloading++;
        squares += n * pow(test->unloading_rms * test->data.max_force, 2);
        n_points += n;
        for (int k = 0; k < GRID; k++) {
            branch->measured[k] += wb_three_point_data_force(
                &test->data, branch->deflection[k] + test->first_contact, true);
            branch->computed[k] +=
                wb_three_point_model_force(g->model, branch->deflection[k], true);
        }
        if (!isfinite(test->residual_measured))
            continue;
        measured += test->residual_measured;
        computed += test->residual_computed;
        n_left++;
    }
    r->residual_measured = n_left > 0 ? measured / n_left : (double)NAN;
    r->residual_computed = n_left > 0 ? computed / n_left : (double)NAN;
    r->unloading_rms_of_tests = branch->rms = branch->largest_error = (double)NAN;
    if (r->n_unloading == 0)
        return WB_OK;
    r->unloading_rms_of_tests = sqrt(squares / (double)n_points) / r->max_force;
    if (!(high > low))
        return WB_OK;
    branch->n = GRID;
    for (int k = 0; k < GRID; k++) {
        branch->measured[k] /= r->n_unloading;
        branch->computed[k] /= r->n_unloading;
        branch->deviation[k] = (double)NAN;
    }
    compute_errors(branch, r->max_force);
    return WB_OK;
}

/* --- error expected from scatter --- */

/* G of validate.h. With a stiffer wire a compliant machine deforms more, too. */
static double find_sensitivity(const struct wb_validate_three_point *r, const struct curve *curve)
{
    double of[GRID];
    for (int k = 0; k < GRID; k++)
        of[k] = curve->force[k] * (1.0 - r->bench.compliance * curve->stiffness[k]) / r->max_force;
    return wb_errors_rms(GRID, of);
}

static int series_of(const struct wb_validate_three_point *r, int i)
{
    for (int k = 0; k < i; k++) {
        if (r->tests[k].is_used &&
            strcmp(r->tests[k].data.info.piece.series, r->tests[i].data.info.piece.series) == 0)
            return k;
    }
    return i;
}

/* Standard deviation over F_max between the means of the series, RMS over the loading. */
static double scatter_of_series(const struct wb_validate_three_point *r)
{
    double squares = 0.0;
    for (int k = 0; k < GRID; k++) {
        double sum = 0.0, sum_squares = 0.0;
        for (int i = 0; i < r->n_tests; i++) {
            double mean = 0.0;
            int n = 0;
            if (!r->tests[i].is_used || series_of(r, i) != i)
                continue;
            for (int j = i; j < r->n_tests; j++) {
                const struct wb_validate_three_point_test *const test = &r->tests[j];
                if (!test->is_used || (j > i && series_of(r, j) != i))
                    continue;
                mean += wb_three_point_data_force(
                    &test->data, r->loading.deflection[k] + test->first_contact, false);
                n++;
            }
            mean /= n * r->max_force;
            sum += mean;
            sum_squares += mean * mean;
        }
        const double n = r->n_series;
        squares += fmax(0.0, sum_squares - sum * sum / n) / (n - 1.0) / GRID;
    }
    return sqrt(squares);
}

static void judge_scatter(struct wb_validate_three_point *r, const struct curve *curve,
                          const struct wb_properties *properties)
{
    const double G = find_sensitivity(r, curve);
    r->is_by_series = r->n_series > 1 || properties->n_series > 1;
    const struct wb_expected_group here = {r->is_by_series ? r->n_series : r->n_used,
                                           !r->is_by_series  ? r->scatter_rms / G
                                           : r->n_series > 1 ? scatter_of_series(r) / G
                                                             : (double)NAN};
    /* One series does not show how much series differ. */
    const bool is_one = r->is_by_series && properties->n_series <= 1;
    const struct wb_expected_group calibration = {
        is_one ? properties->n_samples > 0 : wb_properties_units(properties),
        is_one ? (double)NAN : properties->stiffness_deviation};
    r->expected = wb_expected_find(&here, &calibration, G, r->loading.rms);
}

/* --- the validation --- */

static enum wb_status take_tests(struct group *g, const struct wb_dataset *const *datasets,
                                 struct wb_reason *why)
{
    struct wb_validate_three_point *const r = g->result;
    for (int i = 0; i < r->n_tests; i++) {
        struct wb_validate_three_point_test *const test = &r->tests[i];
        test->is_used = wb_three_point_data_make(&test->data, datasets[i], &g->settings->data,
                                                 &test->why) == WB_OK;
        if (!test->is_used) {
            test->data.info = datasets[i]->info;
            wb_warn("%s: left out", test->why.text);
            continue;
        }
        const struct wb_three_point_data *const data = &test->data;
        const double last = data->points[wb_three_point_data_count_loading(data) - 1].force;
        r->n_used++;
        r->n_series += series_of(r, i) == i;
        g->deepest =
            fmax(g->deepest, data->usable - data->first_contact - r->bench.compliance * last);
    }
    if (r->n_used == 0)
        return wb_fail_to(why, WB_ERR_DATA, "no test can be validated; reason of the first: %s",
                          r->tests[0].why.text);
    if (!(g->deepest > 0.0))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s': the machine's compliance accounts for all of the travel",
                          r->info.wire);
    return WB_OK;
}

static enum wb_status validate(struct group *g, const struct wb_properties *properties,
                               struct wb_reason *why)
{
    struct wb_validate_three_point *const r = g->result;
    struct curve curve;
    WB_TRY(find_places(g, why));
    WB_TRY(find_loading(r, why));
    WB_TRY(compute(g, g->model, g->law, &curve));
    r->largest_curvature = curve.largest_curvature;
    memcpy(r->loading.computed, curve.force, sizeof curve.force);
    compute_errors(&r->loading, r->max_force);
    r->rms_as_read = rms_of(r, curve.force_as_read);
    judge_scatter(r, &curve, properties);
    WB_TRY(find_elastic(g));
    WB_TRY(vary_bench(g));
    WB_TRY(validate_unloading(g));
    r->is_rule_untested = !properties->is_rule_tested;
    r->is_beyond = r->largest_curvature > beyond * properties->largest_curvature;
    if (r->is_beyond)
        wb_warn("wire '%s', span %g mm: the curvature at midspan reaches %.3g /m, but the "
                "properties are known only up to %.3g /m: the prediction is an extrapolation",
                r->info.wire, r->info.length / WB_MM, r->largest_curvature,
                properties->largest_curvature);
    return WB_OK;
}

enum wb_status wb_validate_three_point_run(struct wb_validate_three_point *result,
                                           const struct wb_properties *properties,
                                           const struct wb_dataset *const *datasets, int n,
                                           const struct wb_three_point_calibrate_settings *settings,
                                           struct wb_reason *why)
{
    const double begin = wb_progress_thread_cpu();
    struct group g = {.result = result, .law = &properties->law, .settings = settings};
    *result = (struct wb_validate_three_point){.info = datasets[0]->info, .n_tests = n};
    WB_TRY(wb_validate_check_wire(properties, &result->info, why));
    result->is_compliance_known = result->info.machine.compliance.known;
    wb_three_point_calibrate_bench(&result->info.machine, &result->bench, result->ends);
    result->tests = wb_memory_new((size_t)n, sizeof *result->tests);
    enum wb_status status = take_tests(&g, datasets, why);
    if (status == WB_OK)
        status = create(&g, &result->bench, g.law, &g.model);
    if (status == WB_OK)
        status = validate(&g, properties, why);
    wb_three_point_model_destroy(g.model);
    result->cpu_s = wb_progress_thread_cpu() - begin;
    if (status != WB_OK)
        wb_validate_three_point_release(result);
    return status;
}

enum wb_validate_verdict wb_validate_three_point_verdict(const struct wb_validate_three_point *r)
{
    if (r->is_beyond)
        return WB_VALIDATE_BEYOND;
    if (!isfinite(r->expected.rms_95))
        return WB_VALIDATE_UNDECIDED;
    return r->loading.rms > r->expected.rms_95 ? WB_VALIDATE_NOT_PREDICTED : WB_VALIDATE_PREDICTED;
}

void wb_validate_three_point_release(struct wb_validate_three_point *result)
{
    for (int i = 0; result->tests && i < result->n_tests; i++)
        wb_three_point_data_release(&result->tests[i].data);
    free(result->tests);
    result->tests = NULL;
    result->n_tests = 0;
}

/* --- tables and numbers --- */

enum wb_status wb_validate_three_point_write_csv(const struct wb_validate_three_point *result,
                                                 bool unloading, const char *path)
{
    const struct wb_validate_three_point_branch *const branch =
        unloading ? &result->unloading : &result->loading;
    struct wb_text text = {0};
    wb_validate_tables_put_origin(&text, &result->info, result->n_used);
    wb_text_append(&text, "deflection_mm,measured_N,deviation_N,computed_N,error%s\n",
                   unloading ? "" : ",elastic_N");
    for (int k = 0; k < branch->n; k++) {
        const double row[] = {
            branch->deflection[k] / WB_MM,
            branch->measured[k],
            branch->deviation[k],
            branch->computed[k],
            fabs(branch->measured[k] - branch->computed[k]) / result->max_force,
            isfinite(result->elastic_rms) ? result->elastic[k] : (double)NAN,
        };
        wb_validate_tables_put_row(&text, row, unloading ? WB_COUNT(row) - 1 : WB_COUNT(row));
    }
    return wb_validate_tables_write(&text, path);
}

void wb_validate_three_point_put_scores(struct wb_text *text,
                                        const struct wb_validate_three_point *r)
{
    const double none = (double)NAN, left = r->residual_measured, computed = r->residual_computed;
    wb_validate_tables_put_score(text, &r->info, "loading", (double[]){none, none, r->loading.rms},
                                 "1");
    wb_validate_tables_put_score(text, &r->info, "loading_perfect_model_95",
                                 (double[]){none, none, r->expected.rms_95}, "1");
    if (r->n_unloading == 0)
        return;
    wb_validate_tables_put_score(text, &r->info, "unloading",
                                 (double[]){none, none, r->unloading.rms}, "1");
    wb_validate_tables_put_score(
        text, &r->info, "residual_deflection",
        (double[]){left / WB_MM, computed / WB_MM, (computed - left) / WB_MM}, "mm");
}

static void put_tests(struct wb_json *item, const struct wb_validate_three_point *r)
{
    struct wb_json *const list = wb_json_set_array(item, "tests");
    for (int i = 0; i < r->n_tests; i++) {
        const struct wb_validate_three_point_test *const test = &r->tests[i];
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_integer(entry, "sample", test->data.info.sample);
        wb_json_set_text(entry, "series", test->data.info.piece.series);
        wb_json_set_boolean(entry, "used", test->is_used);
        if (!test->is_used) {
            wb_json_set_text(entry, "why", test->why.text);
            continue;
        }
        wb_json_set_number(entry, "first_contact_mm", test->first_contact / WB_MM);
        wb_json_set_number(entry, "first_contact_as_read_mm", test->data.first_contact / WB_MM);
        wb_json_set_number(entry, "natural_bow_mm", test->bow / WB_MM);
        wb_json_set_boolean(entry, "natural_bow_searched", test->is_bow_searched);
        wb_json_set_number(entry, "rms", test->rms);
        wb_json_set_number(entry, "unloading_rms", test->unloading_rms);
    }
}

void wb_validate_three_point_put_json(struct wb_json *item, const struct wb_validate_three_point *r)
{
    wb_json_set_text(item, "wire", r->info.wire);
    wb_json_set_text(item, "kind", wb_machine_kind_name(r->info.kind));
    wb_json_set_number(item, "span_mm", r->info.length / WB_MM);
    wb_json_set_integer(item, "samples", r->n_used);
    wb_json_set_integer(item, "series", r->n_series);
    wb_json_set_boolean(item, "simulation", r->info.is_simulation);
    wb_json_set_number(item, "nose_radius_mm", r->bench.nose_radius / WB_MM);
    wb_json_set_number(item, "friction", r->bench.friction);
    wb_json_set_number(item, "compliance_mm_N", r->bench.compliance / WB_MM);
    wb_json_set_boolean(item, "compliance_known", r->is_compliance_known);
    wb_json_set_number(item, "max_force_N", r->max_force);
    wb_json_set_number(item, "max_deflection_mm", r->loading.deflection[GRID - 1] / WB_MM);
    struct wb_json *const loading = wb_json_set_object(item, "elastoplastic");
    wb_json_set_number(loading, "rms", r->loading.rms);
    wb_json_set_number(loading, "max_error", r->loading.largest_error);
    wb_json_set_number(loading, "rms_with_contact_as_read", r->rms_as_read);
    wb_json_set_number(wb_json_set_object(item, "elastic"), "rms", r->elastic_rms);
    struct wb_json *const bands = wb_json_set_array(item, "bands");
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        if (r->ends[i].value == (i < 2 ? r->bench.friction : r->bench.nose_radius))
            continue; /* known exactly, not varied */
        struct wb_json *const entry = wb_json_append_object(bands);
        wb_json_set_text(entry, "of", r->ends[i].name);
        wb_json_set_number(entry, i < 2 ? "value" : "value_mm",
                           r->ends[i].value / (i < 2 ? 1.0 : WB_MM));
        wb_json_set_number(entry, "rms", r->bench_rms[i]);
    }
    wb_json_set_number(item, "scatter_rms", r->scatter_rms);
    wb_json_set_boolean(item, "by_series", r->is_by_series);
    wb_json_set_number(item, "stiffness_deviation", r->expected.deviation);
    wb_json_set_integer(item, "stiffness_degrees_of_freedom", r->expected.degrees);
    wb_json_set_number(item, "expected_rms", r->expected.rms);
    wb_json_set_number(item, "expected_rms_95", r->expected.rms_95);
    wb_json_set_number(item, "scatter_share", r->expected.share);
    wb_json_set_number(item, "largest_curvature_1_m", r->largest_curvature);
    wb_json_set_boolean(item, "beyond_known_curvature", r->is_beyond);
    if (r->n_unloading == 0) {
        wb_json_set_number(item, "unloading", (double)NAN);
    } else {
        struct wb_json *const unloading = wb_json_set_object(item, "unloading");
        wb_json_set_integer(unloading, "samples", r->n_unloading);
        wb_json_set_number(unloading, "rms", r->unloading.rms);
        wb_json_set_number(unloading, "max_error", r->unloading.largest_error);
        wb_json_set_number(unloading, "rms_of_samples", r->unloading_rms_of_tests);
        wb_json_set_boolean(unloading, "rule_untested", r->is_rule_untested);
        struct wb_json *const left = wb_json_set_object(item, "residual_deflection_mm");
        wb_json_set_number(left, "measured", r->residual_measured / WB_MM);
        wb_json_set_number(left, "predicted", r->residual_computed / WB_MM);
    }
    put_tests(item, r);
    wb_json_set_number(item, "cpu_s", r->cpu_s);
}
