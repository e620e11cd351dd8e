#include "analysis/validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "analysis/computed.h"
#include "analysis/errors.h"
#include "analysis/marker_distance.h"
#include "analysis/scatter.h"
#include "analysis/validate_private.h"
#include "base/file.h"
#include "base/number.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "validate"

/* Below this deflection the zero of force rules the error, m. */
#define NEAR_ZERO (5.0 * WB_MM)
/* Diameters further apart than this are different wires. */
#define SAME_DIAMETER 0.01
/* Deflection step on the way to one shape, m, and how many steps of force there are. */
#define SHAPE_STEP (1.0 * WB_MM)
#define FORCE_STEPS 100
/* Frames of a follower test's model to a step of the grid, whose ends may be far from each other.
 */
#define FRAMES 4

static enum wb_status check_wire(const struct wb_properties *properties,
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

/* The first point beyond 5 mm; n when there is none. */
static int beyond_zero(const struct wb_curve *curve)
{
    int first = 0;
    if (!curve->is_follower)
        return (int)ceil(NEAR_ZERO / curve->step - 1e-9);
    while (first < curve->n && curve->deflection[first] < NEAR_ZERO)
        first++;
    return first;
}

static enum wb_status predict(struct wb_prediction *prediction, struct wb_computed *computed,
                              const struct wb_material *material, const struct wb_curve *curve,
                              struct wb_reason *why)
{
    const size_t size = (size_t)curve->n;
    prediction->n = curve->n;
    prediction->value = malloc(size * sizeof *prediction->value);
    prediction->error = malloc(size * sizeof *prediction->error);
    if (!prediction->value || !prediction->error)
        return wb_fail_to(why, WB_ERR_MEMORY, "no memory for a prediction of %d points", curve->n);
    WB_TRY(wb_computed_curve(computed, material, curve->n, curve->step, prediction->value,
                             &prediction->n_reached));
    wb_errors_curve(curve->n, curve->value, prediction->value, wb_curve_scale(curve),
                    prediction->error);
    /* Cut short, the errors are of the part that was reached; n_reached is their number. */
    const int n = prediction->n_reached;
    const int first = beyond_zero(curve);
    prediction->rms = n >= 2 ? wb_errors_rms(n, prediction->error) : (double)NAN;
    prediction->max_error = n >= 2 ? wb_errors_largest(n, prediction->error) : (double)NAN;
    prediction->rms_from_5mm =
        n >= first + 2 ? wb_errors_rms(n - first, prediction->error + first) : (double)NAN;
    return WB_OK;
}

/* Square of the standard error of an average. The residual scatter holds what the model does not
 * follow of the bows, the scatter the bows themselves: the smaller bounds what remains. */
static double average_variance(double scatter, double residual, int n)
{
    const double least = fmin(scatter, residual);
    return n > 1 && isfinite(least) ? least * least / n : 0.0;
}

/* What scatter between samples alone makes of two averages, at most. */
static void judge_scatter(struct wb_validate_result *result, const struct wb_properties *properties)
{
    const int n = result->curve.n_samples;
    result->scatter_rms = wb_curve_scatter(&result->curve);
    result->expected_rms = result->scatter_share = (double)NAN;
    if (n < 2)
        return;
    const double square = average_variance(result->scatter_rms, result->residual_scatter_rms, n) +
                          average_variance(properties->scatter_rms,
                                           properties->residual_scatter_rms, properties->n_samples);
    result->expected_rms = sqrt(square);
    const double rms = result->elastoplastic.rms;
    if (rms > 0.0)
        result->scatter_share = fmin(1.0, square / (rms * rms));
}

/* A prediction that goes nowhere is an error, one that is cut short is warned about. */
static enum wb_status check_reached(const struct wb_validate_result *result, struct wb_reason *why)
{
    const struct wb_curve *const curve = &result->curve;
    const int n = result->elastoplastic.n_reached;
    const char *const unit = curve->is_follower ? "N" : "mm";
    const double size = curve->is_follower ? 1.0 : WB_MM;
    if (n < 2)
        return wb_fail_to(
            why, WB_ERR_CONVERGENCE,
            "wire '%s': the beam with the calibrated properties does not converge even "
            "at %g %s",
            result->info.wire, curve->step / size, unit);
    if (n < curve->n)
        wb_warn("wire '%s': the beam stops converging at %.2f of %.2f %s; errors are of that part",
                result->info.wire, (n - 1) * curve->step / size,
                (curve->n - 1) * curve->step / size, unit);
    return WB_OK;
}

static enum wb_status validate_curve(struct wb_validate_result *result,
                                     const struct wb_properties *properties,
                                     const struct wb_dataset *const *datasets, int n,
                                     const struct wb_calibrate_settings *settings,
                                     struct wb_reason *why)
{
    struct wb_material elastic = properties->material;
    const struct wb_computed_settings how = {settings->straight, settings->n_elements,
                                             settings->n_fibres, why};
    struct wb_computed *computed;
    struct wb_marker_distance distance;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    WB_TRY(wb_computed_create(&computed, &result->info, &properties->material, &how));
    const struct wb_curve *const curve = &result->curve;
    const struct wb_marker_distance_range range = {
        curve->is_follower ? curve->step / FRAMES : curve->step,
        curve->is_follower ? curve->max_force : curve->max_deflection};
    enum wb_status status =
        predict(&result->elastoplastic, computed, &properties->material, curve, why);
    if (status == WB_OK)
        status = predict(&result->elastic, computed, &elastic, curve, why);
    if (status == WB_OK)
        status = wb_marker_distance_find(&distance, computed, &properties->material, datasets, n,
                                         &range);
    if (status == WB_OK)
        status = wb_scatter_residual(&result->residual_scatter_rms, datasets, n, curve,
                                     &properties->material, &how);
    if (status == WB_OK) {
        judge_scatter(result, properties);
        result->shape_rms = distance.rms;
        result->shape_max = distance.largest;
        result->n_shape_points = distance.n_points;
        status = check_reached(result, why);
    }
    wb_computed_destroy(computed);
    return status;
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
    WB_TRY(wb_curve_average_on(&made.curve, datasets, n, &grid, why));
    wb_curve_mean_info(datasets, n, &made.info);
    wb_curve_warn_unknown_shapes(datasets, n);
    enum wb_status status = check_wire(properties, &made.info, why);
    if (status == WB_OK && !(wb_curve_scale(&made.curve) > 0.0))
        status = wb_fail_to(why, WB_ERR_DATA, "wire '%s': the measured %s is never positive",
                            made.info.wire, made.curve.is_follower ? "deflection" : "force");
    if (status == WB_OK)
        status = validate_curve(&made, properties, datasets, n, settings, why);
    if (status != WB_OK) {
        wb_validate_result_release(&made);
        return status;
    }
    made.cpu_s = wb_progress_thread_cpu() - started;
    *result = made;
    return WB_OK;
}

/* A number, or an empty field when there is none. */
static void put_field(struct wb_text *text, double value, char end)
{
    char number[WB_NUMBER_TEXT];
    wb_text_append(text, "%s%c", isfinite(value) ? wb_number_format(value, number) : "", end);
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
        put_field(text, i * (curve->step / grid_unit), ',');
        put_field(text, curve->value[i] / unit, ',');
        put_field(text, curve->low[i] / unit, ',');
        put_field(text, curve->high[i] / unit, ',');
        put_field(text, curve->deviation[i] / unit, ',');
        put_field(text, result->elastoplastic.value[i] / unit, ',');
        put_field(text, result->elastoplastic.error[i], ',');
        put_field(text, result->elastic.value[i] / unit, ',');
        put_field(text, result->elastic.error[i], '\n');
    }
}

enum wb_status wb_validate_write_csv(const struct wb_validate_result *result, const char *path)
{
    const struct wb_curve *const curve = &result->curve;
    struct wb_text text = {0};
    char wire[sizeof result->info.wire];
    snprintf(wire, sizeof wire, "%s", result->info.wire);
    for (char *c = wire; *c; c++) {
        if ((unsigned char)*c < 0x20)
            *c = ' ';
    }
    wb_text_append(&text, "# %swire %s, L = %g mm, %d %s, wirebench %s (%s)\n",
                   result->info.is_virtual      ? "virtual rig, "
                   : result->info.is_simulation ? "simulation, "
                                                : "",
                   wire, result->info.length / WB_MM, curve->n_samples,
                   curve->n_samples == 1 ? "sample" : "samples", wb_version(),
                   wb_version_revision());
    put_rows(&text, result);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}

void wb_validate_result_release(struct wb_validate_result *result)
{
    wb_curve_release(&result->curve);
    free(result->elastoplastic.value);
    free(result->elastoplastic.error);
    free(result->elastic.value);
    free(result->elastic.error);
    memset(result, 0, sizeof *result);
}

/* Moves the virgin wire to a deflection in even steps. */
static enum wb_status reach(struct wb_computed *computed, const struct wb_material *material,
                            double deflection)
{
    bool reached;
    double force;
    const int steps = (int)fmin(ceil(fabs(deflection) / SHAPE_STEP), 10000.0);
    WB_TRY(wb_computed_start(computed, material, &reached));
    for (int i = 1; reached && i <= steps; i++)
        WB_TRY(wb_computed_move(computed, deflection * i / steps, &force, &reached));
    if (!reached)
        return wb_fail(WB_ERR_CONVERGENCE, "the beam does not converge on the way to %.2f mm",
                       deflection / WB_MM);
    return WB_OK;
}

/* The same to a follower force. */
static enum wb_status push(struct wb_computed *computed, const struct wb_material *material,
                           double force)
{
    bool reached;
    double deflection;
    WB_TRY(wb_computed_start(computed, material, &reached));
    for (int i = 1; reached && i <= FORCE_STEPS; i++)
        WB_TRY(wb_computed_push(computed, force * i / FORCE_STEPS, &deflection, &reached));
    if (!reached)
        return wb_fail(WB_ERR_CONVERGENCE, "the beam does not converge on the way to %.4g N",
                       force);
    return WB_OK;
}

/* Goes there and takes the shape. */
static enum wb_status
find_shape(const struct wb_properties *properties, const struct wb_test_info *info,
           enum wb_status (*go)(struct wb_computed *, const struct wb_material *, double),
           double target, const struct wb_validate_points *points)
{
    const struct wb_computed_settings how = {0};
    struct wb_computed *computed;
    if (points->n < 2 || !isfinite(target))
        return wb_fail(WB_ERR_ARGUMENT, "a shape needs at least two points and a finite target");
    double *const s = malloc((size_t)points->n * sizeof *s);
    if (!s)
        return wb_fail(WB_ERR_MEMORY, "no memory for a shape of %d points", points->n);
    enum wb_status status = wb_computed_create(&computed, info, &properties->material, &how);
    if (status == WB_OK) {
        for (int i = 0; i < points->n; i++)
            s[i] = info->length * i / (points->n - 1);
        status = go(computed, &properties->material, target);
        if (status == WB_OK)
            wb_computed_shape(computed, points->n, s, points->x, points->y, points->angle);
        wb_computed_destroy(computed);
    }
    free(s);
    return status;
}

enum wb_status wb_validate_shape(const struct wb_properties *properties,
                                 const struct wb_test_info *info, double deflection, int n,
                                 double *x, double *y)
{
    const struct wb_validate_points points = {.n = n, .x = x, .y = y};
    return find_shape(properties, info, reach, deflection, &points);
}

enum wb_status wb_validate_follower_shape(const struct wb_properties *properties,
                                          const struct wb_test_info *info, double force,
                                          const struct wb_validate_points *points)
{
    return find_shape(properties, info, push, force, points);
}
