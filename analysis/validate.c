#include "analysis/validate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "analysis/computed.h"
#include "analysis/errors.h"
#include "analysis/scatter.h"
#include "analysis/shapes.h"
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
/* Deflection step on the way to one shape, m. */
#define SHAPE_STEP (1.0 * WB_MM)

static enum wb_status check_wire(const struct wb_properties *properties,
                                 const struct wb_test_info *info)
{
    const double ratio = info->outer_diameter / properties->outer_diameter;
    if (!(fabs(ratio - 1.0) <= SAME_DIAMETER))
        return wb_fail(WB_ERR_DATA,
                       "the properties are of wire '%s' (%.4g mm across), the datasets of wire "
                       "'%s' (%.4g mm across)",
                       properties->wire, properties->outer_diameter / WB_MM, info->wire,
                       info->outer_diameter / WB_MM);
    if (strcmp(properties->wire, info->wire) != 0)
        wb_warn("the properties are of wire '%s', the datasets of wire '%s' of the same diameter",
                properties->wire, info->wire);
    return WB_OK;
}

static enum wb_status predict(struct wb_prediction *prediction, struct wb_computed *computed,
                              const struct wb_material *material, const struct wb_curve *curve)
{
    const size_t size = (size_t)curve->n;
    prediction->n = curve->n;
    prediction->force = malloc(size * sizeof *prediction->force);
    prediction->error = malloc(size * sizeof *prediction->error);
    if (!prediction->force || !prediction->error)
        return wb_fail(WB_ERR_MEMORY, "no memory for a prediction of %d points", curve->n);
    WB_TRY(wb_computed_curve(computed, material, curve->n, curve->step, prediction->force,
                             &prediction->n_reached));
    wb_errors_curve(curve->n, curve->force, prediction->force, curve->max_force, prediction->error);
    /* Cut short, the errors are of the part that was reached; n_reached tells. */
    const int n = prediction->n_reached;
    const int first = (int)ceil(NEAR_ZERO / curve->step - 1e-9);
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

static enum wb_status validate_curve(struct wb_validate_result *result,
                                     const struct wb_properties *properties,
                                     const struct wb_dataset *const *datasets, int n,
                                     const struct wb_validate_settings *settings)
{
    struct wb_material elastic = properties->material;
    const struct wb_computed_settings how = {settings->straight, settings->n_elements,
                                             settings->n_fibres};
    struct wb_computed *computed;
    struct wb_shapes_distance distance;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    WB_TRY(wb_computed_create(&computed, &result->info, &properties->material, &how));
    const struct wb_curve *const curve = &result->curve;
    const struct wb_shapes_range range = {curve->step, curve->max_deflection};
    enum wb_status status = predict(&result->elastoplastic, computed, &properties->material, curve);
    if (status == WB_OK)
        status = predict(&result->elastic, computed, &elastic, curve);
    if (status == WB_OK)
        status = wb_shapes_compare(&distance, computed, &properties->material, datasets, n, &range);
    if (status == WB_OK)
        status = wb_scatter_residual(&result->residual_scatter_rms, datasets, n, curve,
                                     &properties->material, &how);
    if (status == WB_OK) {
        judge_scatter(result, properties);
        result->shape_rms = distance.rms;
        result->shape_max = distance.largest;
        result->n_shape_points = distance.n_points;
        if (result->elastoplastic.n_reached < 2)
            status = wb_fail(WB_ERR_CONVERGENCE,
                             "wire '%s': the beam with the calibrated properties does not "
                             "converge even at %g mm",
                             result->info.wire, curve->step / WB_MM);
        else if (result->elastoplastic.n_reached < curve->n)
            wb_warn("wire '%s': the beam stops converging at %.2f of %.2f mm; errors are of that "
                    "part",
                    result->info.wire, (result->elastoplastic.n_reached - 1) * curve->step / WB_MM,
                    curve->max_deflection / WB_MM);
    }
    wb_computed_destroy(computed);
    return status;
}

enum wb_status wb_validate_run(struct wb_validate_result *result,
                               const struct wb_properties *properties,
                               const struct wb_dataset *const *datasets, int n,
                               const struct wb_validate_settings *settings)
{
    const struct wb_validate_settings defaults = {0};
    const double started = wb_progress_thread_cpu();
    struct wb_validate_result made = {0};
    if (!settings)
        settings = &defaults;
    WB_TRY(wb_curve_average(&made.curve, datasets, n, settings->step));
    wb_curve_mean_info(datasets, n, &made.info);
    wb_curve_warn_unknown_shapes(datasets, n);
    enum wb_status status = check_wire(properties, &made.info);
    if (status == WB_OK && !(made.curve.max_force > 0.0))
        status =
            wb_fail(WB_ERR_DATA, "wire '%s': the measured force is never positive", made.info.wire);
    if (status == WB_OK)
        status = validate_curve(&made, properties, datasets, n, settings);
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
    wb_text_append(&text, "deflection_mm,measured_N,low_N,high_N,deviation_N,elastoplastic_N,"
                          "elastoplastic_error,elastic_N,elastic_error\n");
    for (int i = 0; i < curve->n; i++) {
        put_field(&text, i * (curve->step / WB_MM), ',');
        put_field(&text, curve->force[i], ',');
        put_field(&text, curve->low[i], ',');
        put_field(&text, curve->high[i], ',');
        put_field(&text, curve->deviation[i], ',');
        put_field(&text, result->elastoplastic.force[i], ',');
        put_field(&text, result->elastoplastic.error[i], ',');
        put_field(&text, result->elastic.force[i], ',');
        put_field(&text, result->elastic.error[i], '\n');
    }
    enum wb_status status;
    if (text.failed)
        status = wb_fail(WB_ERR_MEMORY, "no memory for '%s'", path);
    else
        status = wb_file_write(path, wb_text_string(&text), text.length);
    wb_text_release(&text);
    return status;
}

void wb_validate_result_release(struct wb_validate_result *result)
{
    wb_curve_release(&result->curve);
    free(result->elastoplastic.force);
    free(result->elastoplastic.error);
    free(result->elastic.force);
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

enum wb_status wb_validate_shape(const struct wb_properties *properties,
                                 const struct wb_test_info *info, double deflection, int n,
                                 double *x, double *y)
{
    const struct wb_computed_settings how = {0};
    struct wb_computed *computed;
    if (n < 2 || !isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "a shape needs at least two points and a deflection");
    double *const s = malloc((size_t)n * sizeof *s);
    if (!s)
        return wb_fail(WB_ERR_MEMORY, "no memory for a shape of %d points", n);
    enum wb_status status = wb_computed_create(&computed, info, &properties->material, &how);
    if (status == WB_OK) {
        for (int i = 0; i < n; i++)
            s[i] = info->length * i / (n - 1);
        status = reach(computed, &properties->material, deflection);
        if (status == WB_OK)
            wb_computed_shape(computed, n, s, x, y);
        wb_computed_destroy(computed);
    }
    free(s);
    return status;
}
