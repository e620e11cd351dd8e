#include "analysis/validation/validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_bow.h"
#include "analysis/calibration/paper/computed.h"
#include "analysis/calibration/paper/scatter.h"
#include "analysis/dataset/errors.h"
#include "analysis/validation/expected.h"
#include "analysis/validation/marker_distance.h"
#include "analysis/validation/validate_bounds.h"
#include "analysis/validation/validate_tables.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "validate"

/* Below this deflection (m) the error of the force's zero dominates. */
#define NEAR_ZERO (5.0 * WB_MM)
/* Relative difference of diameters above which two wires are different. */
#define SAME_DIAMETER 0.01
/* Deflection step towards a shape, m. */
#define SHAPE_STEP (1.0 * WB_MM)
/* Frames of a follower test's model per step of the grid, between which the deflection may change a
 * lot. */
#define FRAMES 4
/* Curvatures larger than the known ones by this factor are reported as beyond. The factor excludes
 * tests like the calibration's own, whose curvatures are known up to those of the least bent
 * specimen. */
#define BEYOND 1.1

enum wb_status wb_validate_check_wire(const struct wb_properties *properties,
                                      const struct wb_test_info *info, struct wb_reason *why)
{
    const double ratio = info->outer_diameter / properties->outer_diameter;
    if (!(fabs(ratio - 1.0) <= SAME_DIAMETER))
        return wb_fail_to(why, WB_ERR_DATA,
                          "the properties are of wire '%s' (%.4g mm across), the datasets of wire "
                          "'%s' (%.4g mm across)",
                          properties->wire, properties->outer_diameter / WB_MM, info->wire,
                          info->outer_diameter / WB_MM);
    if (strcmp(properties->wire, info->wire) != 0)
        wb_warn("the properties are of wire '%s', the datasets of wire '%s' of the same diameter",
                properties->wire, info->wire);
    return WB_OK;
}

/* The first point beyond 5 mm; n if there is none. */
static int beyond_zero(const struct wb_curve *curve)
{
    int first = 0;
    if (!curve->is_follower)
        return (int)ceil(NEAR_ZERO / curve->step - 1e-9);
    while (first < curve->n && curve->deflection[first] < NEAR_ZERO)
        first++;
    return first;
}

/* Allocates the arrays of a prediction. */
static void take_room(struct wb_prediction *prediction, const struct wb_curve *curve)
{
    const size_t size = (size_t)curve->n;
    prediction->n = curve->n;
    prediction->value = wb_memory_new(size, sizeof *prediction->value);
    prediction->error = wb_memory_new(size, sizeof *prediction->error);
}

/* Computes the errors of the predicted values. */
static void compute_errors(struct wb_prediction *prediction, const struct wb_curve *curve)
{
    wb_errors_curve(curve->n, curve->value, prediction->value, wb_curve_scale(curve),
                    prediction->error);
    /* A prediction that was cut short is scored over the part that it reached. */
    const int n = prediction->n_reached;
    const int first = beyond_zero(curve);
    prediction->rms = n >= 2 ? wb_errors_rms(n, prediction->error) : (double)NAN;
    prediction->max_error = n >= 2 ? wb_errors_largest(n, prediction->error) : (double)NAN;
    prediction->rms_from_5mm =
        n >= first + 2 ? wb_errors_rms(n - first, prediction->error + first) : (double)NAN;
}

/* Computes the curve of one test on the grid of `curve`. */
static enum wb_status compute_curve(double *value, int *n_reached, const struct wb_test_info *info,
                                    const struct wb_material *material,
                                    const struct wb_curve *curve,
                                    const struct wb_computed_settings *how)
{
    struct wb_computed *computed;
    WB_TRY(wb_computed_create(&computed, info, material, how));
    const enum wb_status status =
        wb_computed_curve(computed, material, curve->n, curve->step, value, n_reached);
    wb_computed_destroy(computed);
    return status;
}

/* Mean of the predictions for each sample's own bow. Wires bowed up and down yield differently, so
 * the curve of the mean bow is not the mean curve. */
static enum wb_status predict_mean(struct wb_prediction *prediction,
                                   const struct wb_dataset *const *datasets, int n,
                                   const struct wb_material *material, const struct wb_curve *curve,
                                   const struct wb_computed_settings *how)
{
    take_room(prediction, curve);
    double *const value = wb_memory_new((size_t)curve->n, sizeof *value);
    enum wb_status status = WB_OK;
    prediction->n_reached = curve->n;
    for (int i = 0; status == WB_OK && i < n; i++) {
        int reached = 0;
        status = compute_curve(value, &reached, &datasets[i]->info, material, curve, how);
        for (int k = 0; status == WB_OK && k < curve->n; k++)
            prediction->value[k] += value[k] / n;
        prediction->n_reached = reached < prediction->n_reached ? reached : prediction->n_reached;
    }
    free(value);
    if (status == WB_OK)
        compute_errors(prediction, curve);
    return status;
}

/* --- error expected from scatter --- */

/* G of validate.h: root mean square of dF/d ln k over F_max; NaN if the beam does not reach the end
 * of the curve. */
static enum wb_status find_sensitivity(double *G, const struct wb_validate_result *result,
                                       const struct wb_law *law,
                                       const struct wb_computed_settings *how)
{
    const struct wb_curve *const curve = &result->curve;
    const double by = wb_validate_stiffer_by;
    double *const value = wb_memory_new(2 * (size_t)curve->n, sizeof *value);
    enum wb_status status = WB_OK;
    bool complete = true;
    for (int side = 0; status == WB_OK && side < 2; side++) {
        const struct wb_law scaled = wb_validate_stiffer(law, side == 0 ? -by : by);
        struct wb_computed_settings with = *how;
        int reached = 0;
        with.law = how->law ? &scaled : NULL;
        status = compute_curve(value + side * curve->n, &reached, &result->info, &scaled.material,
                               curve, &with);
        complete = complete && reached == curve->n;
    }
    for (int i = 0; status == WB_OK && complete && i < curve->n; i++)
        value[i] = (value[curve->n + i] - value[i]) / (2.0 * by * wb_curve_scale(curve));
    *G = status == WB_OK && complete ? wb_errors_rms(curve->n, value) : (double)NAN;
    free(value);
    return status;
}

/* s of specimens whose curves have this scatter. The residual scatter contains errors of the model
 * for bows that the specimens do not have, so the smaller of the two is used. */
static double deviation_of(double scatter, double residual_scatter, double G)
{
    return isfinite(scatter) ? fmin(scatter, residual_scatter) / G : (double)NAN;
}

/* Error of a perfect model expected from scatter between specimens; see validate.h. If the
 * properties do not give the calibration's scatter of stiffness, it follows from the scatter of its
 * curves, as G changes little with the length. */
static void judge_scatter(struct wb_validate_result *result, const struct wb_properties *properties,
                          double G)
{
    const int n = result->curve.n_samples, m = wb_properties_units(properties);
    result->scatter_rms = wb_curve_scatter(&result->curve);
    const double own = deviation_of(result->scatter_rms, result->residual_scatter_rms, G);
    const double calibrated =
        isfinite(properties->stiffness_deviation)
            ? properties->stiffness_deviation
            : deviation_of(properties->scatter_rms, properties->residual_scatter_rms, G);
    const struct wb_expected e =
        wb_expected_find(&(struct wb_expected_group){n, own},
                         &(struct wb_expected_group){m, calibrated}, G, result->elastoplastic.rms);
    result->stiffness_deviation = e.deviation;
    result->stiffness_degrees = e.degrees;
    result->expected_rms = e.rms;
    result->expected_rms_95 = e.rms_95;
    result->scatter_share = e.share;
}

/* A prediction that does not start is an error, one that is cut short a warning. */
static enum wb_status check_reached(const struct wb_validate_result *result, struct wb_reason *why)
{
    const struct wb_curve *const curve = &result->curve;
    const int n = result->elastoplastic.n_reached;
    const char *const unit = curve->is_follower ? "N" : "mm";
    const double size = curve->is_follower ? 1.0 : WB_MM;
    if (n < 2)
        return wb_fail_to(
            why, WB_ERR_CONVERGENCE,
            "wire '%s': the beam with the calibrated properties does not converge even at %g %s",
            result->info.wire, curve->step / size, unit);
    if (n < curve->n)
        wb_warn(
            "wire '%s': the beam converges only up to %.2f of %.2f %s; the errors are of that part",
            result->info.wire, (n - 1) * curve->step / size, (curve->n - 1) * curve->step / size,
            unit);
    return WB_OK;
}

/* The law for a run in addition to its material; NULL for a plain law, which its material describes
 * completely. */
static const struct wb_law *overlay_of(const struct wb_properties *properties)
{
    const bool is_plain = wb_law_is_plain(&properties->law) && properties->law.n_maxwell == 0;
    return is_plain ? NULL : &properties->law;
}

/* Mean rate of deflection of the first loadings, m/s; 0 if a dataset has no times or is a follower
 * test. */
static double loading_speed(const struct wb_dataset *const *datasets, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        const struct wb_dataset *const dataset = datasets[i];
        const size_t end = wb_curve_end_of_loading(dataset, 0.0);
        size_t first = 0;
        while (first < end && !(dataset->rows[first].deflection > 0.0))
            first++;
        if (dataset->info.is_follower || first >= end)
            return 0.0;
        const struct wb_row *const from = &dataset->rows[first], *const to =
                                                                     &dataset->rows[end - 1];
        if (!(to->t > from->t))
            return 0.0;
        sum += (to->deflection - from->deflection) / (to->t - from->t) / n;
    }
    return sum;
}

/* The elastic prediction for comparison. */
static enum wb_status predict_elastic(struct wb_validate_result *result,
                                      const struct wb_material *material,
                                      const struct wb_computed_settings *how)
{
    struct wb_computed_settings without = *how;
    struct wb_material elastic = *material;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    without.law = NULL;
    take_room(&result->elastic, &result->curve);
    WB_TRY(compute_curve(result->elastic.value, &result->elastic.n_reached, &result->info, &elastic,
                         &result->curve, &without));
    compute_errors(&result->elastic, &result->curve);
    return WB_OK;
}

static enum wb_status validate_curve(struct wb_validate_result *result,
                                     const struct wb_properties *properties,
                                     const struct wb_dataset *const *datasets, int n,
                                     const struct wb_calibrate_settings *settings,
                                     struct wb_reason *why)
{
    const struct wb_material *const material = &properties->law.material;
    const struct wb_computed_settings how = {settings->straight,     settings->n_elements,
                                             settings->n_fibres,     why,
                                             overlay_of(properties), loading_speed(datasets, n)};
    struct wb_computed *computed;
    struct wb_marker_distance distance;
    double G;
    WB_TRY(wb_computed_create(&computed, &result->info, material, &how));
    const struct wb_curve *const curve = &result->curve;
    const struct wb_marker_distance_range range = {
        curve->is_follower ? curve->step / FRAMES : curve->step,
        curve->is_follower ? curve->max_force : curve->max_deflection};
    enum wb_status status =
        predict_mean(&result->elastoplastic, datasets, n, material, curve, &how);
    if (status == WB_OK)
        status = predict_elastic(result, material, &how);
    if (status == WB_OK)
        status = wb_marker_distance_find(&distance, computed, material, datasets, n, &range);
    wb_computed_destroy(computed);
    if (status == WB_OK)
        status =
            wb_scatter_residual(&result->residual_scatter_rms, datasets, n, curve, material, &how);
    if (status == WB_OK)
        status = find_sensitivity(&G, result, &properties->law, &how);
    WB_TRY(status);
    judge_scatter(result, properties, G);
    result->shape_rms = distance.rms;
    result->shape_max = distance.largest;
    result->n_shape_points = distance.n_points;
    result->shapes = distance.mean;
    return check_reached(result, why);
}

/* The unloading and later cycles; a test without them is valid. */
static enum wb_status validate_cycles(struct wb_validate_result *result,
                                      const struct wb_properties *properties,
                                      const struct wb_dataset *const *datasets, int n,
                                      const struct wb_calibrate_settings *settings)
{
    const struct wb_validate_cycle_settings how = {settings->straight, settings->n_elements,
                                                   settings->n_fibres, result->curve.max_force};
    const double known = properties->largest_curvature;
    result->is_rule_untested =
        isfinite(known) ? !properties->is_rule_tested : wb_law_is_plain(&properties->law);
    result->cycles.clamp_curvature = (double)NAN;
    if (result->curve.is_follower)
        return WB_OK;
    WB_TRY(wb_validate_cycles_run(&result->cycles, &properties->law, datasets, n, &how));
    result->is_beyond = result->cycles.clamp_curvature > BEYOND * known;
    if (result->is_beyond)
        wb_warn("wire '%s', L = %g mm: the curvature at the clamp reaches %.3g /m, but the "
                "properties are known only up to %.3g /m: the prediction is an extrapolation",
                result->info.wire, result->info.length / WB_MM, result->cycles.clamp_curvature,
                known);
    return WB_OK;
}

/* Copies the datasets with the bows that the properties find
 * (analysis/calibration/cycle/cycle_bow.h); their rows are borrowed. The bow is left as aligned
 * for a law of loading alone, whose E is uncertain, and for a sample whose first cycle cannot be
 * read. */
static enum wb_status find_bows(struct wb_dataset *bent, const struct wb_dataset *const *datasets,
                                int n, const struct wb_properties *properties,
                                const struct wb_calibrate_settings *settings)
{
    const struct wb_cycle_model_settings how = {settings->n_elements, settings->n_fibres};
    for (int i = 0; i < n; i++) {
        struct wb_test_info *const info = &bent[i].info;
        struct wb_reason unused = {.text = ""};
        struct wb_cycle_data data;
        double angle;
        bent[i] = *datasets[i];
        if (settings->straight || !properties->is_rule_tested ||
            wb_cycle_data_take(&data, &bent[i], NULL, &unused) != WB_OK)
            continue;
        const enum wb_status status =
            wb_cycle_bow_find(&angle, &bent[i], &data, &properties->law, &how);
        wb_cycle_data_release(&data);
        WB_TRY(status);
        if (info->n_natural_shape > 0)
            info->natural_shape[0] += angle - 2.0 * wb_dataset_bow(info) / info->length;
    }
    return WB_OK;
}

enum wb_status wb_validate_run(struct wb_validate_result *result,
                               const struct wb_properties *properties,
                               const struct wb_dataset *const *datasets, int n,
                               const struct wb_calibrate_settings *settings, struct wb_reason *why)
{
    struct wb_calibrate_settings defaults;
    const double started = wb_progress_thread_cpu();
    struct wb_validate_result made = {0};
    wb_calibrate_default_settings(&defaults);
    if (!settings)
        settings = &defaults;
    const struct wb_curve_grid grid = {.step = settings->step,
                                       .force_step = settings->force_step,
                                       .largest_deflection = settings->largest_deflection};
    struct wb_dataset *const bent = wb_memory_new((size_t)n, sizeof *bent);
    const struct wb_dataset **const list = wb_memory_new((size_t)n, sizeof *list);
    enum wb_status status = wb_curve_average_on(&made.curve, datasets, n, &grid, why);
    if (status == WB_OK) {
        wb_curve_mean_info(datasets, n, &made.info);
        wb_curve_warn_unknown_shapes(datasets, n);
        status = wb_validate_check_wire(properties, &made.info, why);
    }
    if (status == WB_OK && !(wb_curve_scale(&made.curve) > 0.0))
        status = wb_fail_to(why, WB_ERR_DATA, "wire '%s': the measured %s is never positive",
                            made.info.wire, made.curve.is_follower ? "deflection" : "force");
    if (status == WB_OK)
        status = find_bows(bent, datasets, n, properties, settings);
    for (int i = 0; status == WB_OK && i < n; i++)
        list[i] = &bent[i];
    if (status == WB_OK) {
        wb_curve_mean_info(list, n, &made.info);
        status = validate_curve(&made, properties, list, n, settings, why);
    }
    if (status == WB_OK)
        status = validate_cycles(&made, properties, list, n, settings);
    if (status == WB_OK)
        wb_validate_bounds_find(&made, properties);
    free(bent);
    free(list);
    if (status != WB_OK) {
        wb_validate_result_release(&made);
        return status;
    }
    made.cpu_s = wb_progress_thread_cpu() - started;
    *result = made;
    return WB_OK;
}

static void put_rows(struct wb_text *text, const struct wb_validate_result *result)
{
    const struct wb_curve *const curve = &result->curve;
    const bool follows = curve->is_follower;
    const double grid_unit = follows ? 1.0 : WB_MM, unit = follows ? WB_MM : 1.0;
    wb_text_append(text, follows
                             ? "force_N,measured_mm,low_mm,high_mm,deviation_mm,elastoplastic_mm,"
                               "elastoplastic_error,elastic_mm,elastic_error\n"
                             : "deflection_mm,measured_N,low_N,high_N,deviation_N,elastoplastic_N,"
                               "elastoplastic_error,elastic_N,elastic_error\n");
    for (int i = 0; i < curve->n; i++) {
        const double row[] = {i * (curve->step / grid_unit),  curve->value[i] / unit,
                              curve->low[i] / unit,           curve->high[i] / unit,
                              curve->deviation[i] / unit,     result->elastoplastic.value[i] / unit,
                              result->elastoplastic.error[i], result->elastic.value[i] / unit,
                              result->elastic.error[i]};
        wb_validate_tables_put_row(text, row, WB_COUNT(row));
    }
}

enum wb_status wb_validate_write_csv(const struct wb_validate_result *result, const char *path)
{
    struct wb_text text = {0};
    wb_validate_tables_put_origin(&text, &result->info, result->curve.n_samples);
    put_rows(&text, result);
    return wb_validate_tables_write(&text, path);
}

enum wb_status wb_validate_write_unloading(const struct wb_validate_result *result,
                                           const char *path)
{
    const struct wb_validate_cycles *const cycles = &result->cycles;
    struct wb_text text = {0};
    wb_validate_tables_put_origin(&text, &result->info, result->curve.n_samples);
    wb_text_append(&text, "deflection_mm,measured_N,elastoplastic_N,elastoplastic_error\n");
    for (int i = 0; i < cycles->n; i++) {
        const double difference = cycles->measured[i] - cycles->computed[i];
        const double row[] = {cycles->deflection[i] / WB_MM, cycles->measured[i],
                              cycles->computed[i], fabs(difference) / result->curve.max_force};
        wb_validate_tables_put_row(&text, row, WB_COUNT(row));
    }
    return wb_validate_tables_write(&text, path);
}

void wb_validate_put_scores(struct wb_text *text, const struct wb_validate_result *result)
{
    const struct wb_validate_cycles *const cycles = &result->cycles;
    const double none = (double)NAN;
    wb_validate_tables_put_score(text, &result->info, "loading",
                                 (double[]){none, none, result->elastoplastic.rms}, "1");
    wb_validate_tables_put_score(text, &result->info, "loading_perfect_model_95",
                                 (double[]){none, none, result->expected_rms_95}, "1");
    wb_validate_tables_put_score(text, &result->info, "shapes",
                                 (double[]){none, none, result->shape_rms / WB_MM}, "mm");
    for (int i = 0; i < WB_VALIDATE_PARTS; i++) {
        const struct wb_validate_bound *const bound = &result->bounds[i];
        const double unit = wb_validate_part_unit(i);
        char name[40];
        snprintf(name, sizeof name, "bound_%s", wb_validate_part_key(i));
        if (isfinite(bound->bound))
            wb_validate_tables_put_score(
                text, &result->info, name,
                (double[]){bound->found / unit, bound->bound / unit, (double)bound->is_exceeded},
                unit == WB_MM ? "mm" : "1");
    }
    if (cycles->n_samples == 0)
        return;
    wb_validate_tables_put_score(text, &result->info, "unloading",
                                 (double[]){none, none, cycles->rms}, "1");
    const double left = cycles->residual_measured, computed_left = cycles->residual_computed;
    wb_validate_tables_put_score(
        text, &result->info, "residual_deflection",
        (double[]){left / WB_MM, computed_left / WB_MM, (computed_left - left) / WB_MM}, "mm");
    for (int i = 0; i < cycles->n_loops; i++) {
        const struct wb_validate_loop *const loop = &cycles->loops[i];
        char name[40];
        snprintf(name, sizeof name, "loop_energy_cycle_%d", loop->cycle);
        wb_validate_tables_put_score(text, &result->info, name,
                                     (double[]){loop->measured / WB_MJ, loop->computed / WB_MJ,
                                                loop->computed / loop->measured - 1.0},
                                     "mJ");
    }
}

void wb_validate_result_release(struct wb_validate_result *result)
{
    wb_curve_release(&result->curve);
    free(result->elastoplastic.value);
    free(result->elastoplastic.error);
    free(result->elastic.value);
    free(result->elastic.error);
    wb_validate_cycles_release(&result->cycles);
    memset(result, 0, sizeof *result);
}

/* Moves the virgin wire to a deflection in equal steps. */
static enum wb_status move_to_deflection(struct wb_computed *computed,
                                         const struct wb_material *material, double deflection)
{
    bool reached;
    double force;
    const int steps = (int)fmin(ceil(fabs(deflection) / SHAPE_STEP), 10000.0);
    WB_TRY(wb_computed_start(computed, material, &reached));
    for (int i = 1; reached && i <= steps; i++)
        WB_TRY(wb_computed_move(computed, deflection * i / steps, &force, &reached));
    if (!reached)
        return wb_fail(WB_ERR_CONVERGENCE, "the beam does not converge before %.2f mm",
                       deflection / WB_MM);
    return WB_OK;
}

enum wb_status wb_validate_shape(const struct wb_properties *properties,
                                 const struct wb_test_info *info, double deflection, int n,
                                 double *x, double *y)
{
    const struct wb_computed_settings how = {.law = overlay_of(properties)};
    const struct wb_material *const material = &properties->law.material;
    struct wb_computed *computed;
    if (n < 2 || !isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "a shape needs at least two points and a finite target");
    WB_TRY(wb_computed_create(&computed, info, material, &how));
    const enum wb_status status = move_to_deflection(computed, material, deflection);
    if (status == WB_OK) {
        double *const s = wb_memory_new((size_t)n, sizeof *s);
        for (int i = 0; i < n; i++)
            s[i] = info->length * i / (n - 1);
        wb_computed_shape(computed, n, s, x, y, NULL);
        free(s);
    }
    wb_computed_destroy(computed);
    return status;
}
