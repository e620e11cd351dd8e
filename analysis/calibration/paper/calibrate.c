#include "analysis/calibration/paper/calibrate.h"

#include <math.h>
#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multimin.h>

#include "analysis/calibration/paper/calibrate_private.h"
#include "analysis/calibration/paper/computed.h"
#include "analysis/calibration/paper/first_guess.h"
#include "analysis/calibration/paper/jackknife.h"
#include "analysis/calibration/paper/refit.h"
#include "analysis/calibration/paper/scatter.h"
#include "analysis/dataset/curve.h"
#include "analysis/dataset/errors.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "calibrate"

/* Edges of the paper's initial simplex: 5 % of K0 and of n0. */
#define SIMPLEX_STEP 0.05
/* Domain of the search; outside, the error is a penalty. */
#define SMALLEST_EXPONENT 0.01
#define LARGEST_EXPONENT 1.5
#define SMALLEST_STRENGTH_RATIO 1e-6 /* K over K0 */
#define LARGEST_STRENGTH_RATIO 1e6
/* Error of a point outside the domain, or one that a beam could not compute: far above the error of
 * any curve. */
#define PENALTY 10.0
/* Force over the linear elastic prediction above which a test counts as not yielded. */
#define ELASTIC_SHARE 0.95

/* Bow over length above which the bias of eqs. 10 and 11 exceeds a few percent. */
#define LARGE_BOW 0.01
/* Relative distance within which an optimum counts as being at a bound of the search. */
#define AT_BOUND 1e-3
/* Number of iterations of the correction for bows. */
#define BOW_PASSES 2

/* Data of one evaluation of the error. */
struct objective {
    struct wb_computed *computed;
    const struct wb_curve *curve;
    int n;                       /* points of the curve that are compared */
    struct wb_material material; /* with K and n of the last evaluation */
    double first_strength, first_exponent;
    double *value;         /* (curve->n) */
    enum wb_status status; /* last failure other than non-convergence */
    struct wb_reason *why; /* NULL: failures are logged */
    int evaluations, failed;
};

static const struct wb_setting rows[] = {
    {WB_ROW_NUMBER(wb_calibrate_settings, elastic_zone, "elastic_zone", 1e-3, 0.3, 0.05),
     WB_ROW_OPTION("elastic-zone", "R", "Deflection over length for E, eq. 10"),
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_CAMPAIGN | WB_CALIBRATE_REPORT},
    {WB_ROW_NUMBER(wb_calibrate_settings, yield_point, "yield_point", 1e-3, 0.3, 0.0),
     WB_ROW_OPTION(
         "yield-point", "R",
         "Deflection over length for the yield stress, eq. 11; the paper's tables show 0.04"),
     .otherwise = "as the elastic zone",
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_CAMPAIGN | WB_CALIBRATE_REPORT},
    {WB_ROW_QUANTITY(wb_calibrate_settings, step, "step_mm", "mm", WB_MM, 1e-2, 100.0, 0.5),
     WB_ROW_OPTION("step-mm", "H", "Deflection step of the comparison"),
     .applies = WB_CALIBRATE_EVERYWHERE},
    {WB_ROW_BOOLEAN(wb_calibrate_settings, straight, "straight", false),
     WB_ROW_OPTION("straight", NULL, "Ignore the natural shape (bow) of the specimens"),
     .applies = WB_CALIBRATE_EVERYWHERE},
    {WB_ROW_BOOLEAN(wb_calibrate_settings, restart, "restart", true),
     WB_ROW_OPTION("no-restart", NULL, "Do not restart the simplex from the optimum"),
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_CAMPAIGN | WB_CALIBRATE_REPORT},
    {WB_ROW_INTEGER(wb_calibrate_settings, n_elements, "elements", 2, 2000, 50),
     WB_ROW_OPTION("elements", "N", "Beam elements"), .applies = WB_CALIBRATE_EVERYWHERE},
    {WB_ROW_INTEGER(wb_calibrate_settings, n_fibres, "fibres", 4, 1000, 20),
     WB_ROW_OPTION("fibres", "N", "Fibres over the diameter"), .applies = WB_CALIBRATE_EVERYWHERE},
    {WB_ROW_NUMBER(wb_calibrate_settings, size_tolerance, "size_tolerance", 1e-12, 0.05, 1e-4),
     WB_ROW_OPTION("size-tolerance", "X",
                   "Stop when the simplex is smaller, in units of K0 and n0"),
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_REPORT},
    {WB_ROW_NUMBER(wb_calibrate_settings, error_tolerance, "error_tolerance", 0.0, 1.0, 1e-4),
     WB_ROW_OPTION("error-tolerance", "X", "Stop when the error over F_max is smaller"),
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_REPORT},
    {WB_ROW_INTEGER(wb_calibrate_settings, max_iterations, "max_iterations", 1, 100000, 200),
     WB_ROW_OPTION("max-iterations", "N", "Stop after N iterations of a simplex"),
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_CAMPAIGN | WB_CALIBRATE_REPORT},
    {WB_ROW_BOOLEAN(wb_calibrate_settings, bow_corrected, "bow_corrected", false),
     WB_ROW_OPTION(
         "bow-corrected", NULL,
         "Correct E and the yield stress for the effect of the specimens' bows on eqs. 10 and 11"),
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_CAMPAIGN},
    {WB_ROW_QUANTITY(wb_calibrate_settings, youngs_modulus, "youngs_modulus_MPa", "MPa", WB_MPA,
                     1e-3, 1e7, 0.0),
     WB_ROW_OPTION("youngs-modulus-mpa", "E", "Young's modulus"), .otherwise = "eq. 10",
     .applies = WB_CALIBRATE_COMMAND},
    {WB_ROW_QUANTITY(wb_calibrate_settings, yield_stress, "yield_stress_MPa", "MPa", WB_MPA, 1e-6,
                     1e7, 0.0),
     WB_ROW_OPTION("yield-stress-mpa", "S", "Yield stress"), .otherwise = "eq. 11",
     .applies = WB_CALIBRATE_COMMAND},
    {WB_ROW_QUANTITY(wb_calibrate_settings, force_step, "force_step_N", "N", 1.0, 1e-9, 1e6, 0.0),
     WB_ROW_OPTION(
         "force-step-n", "H",
         "Force step of the comparison of tests with a follower force, whose deflections are "
         "compared at equal forces"),
     .otherwise = "a step for each row, at most 100",
     .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_VALIDATE},
    {WB_ROW_QUANTITY(wb_calibrate_settings, largest_deflection, "largest_deflection_mm", "mm",
                     WB_MM, 1e-3, 1e6, 0.0),
     WB_ROW_OPTION("largest-deflection-mm", "D", "Ignore the loading beyond this deflection"),
     .otherwise = "nothing", .applies = WB_CALIBRATE_COMMAND | WB_CALIBRATE_VALIDATE},
};

const struct wb_setting_table wb_calibrate_table = {WB_SETTING_ROWS(rows)};

void wb_calibrate_default_settings(struct wb_calibrate_settings *settings)
{
    *settings = (struct wb_calibrate_settings){.progress = NULL};
    wb_setting_fill(&wb_calibrate_table, settings);
}

struct wb_calibrate_settings
wb_calibrate_settings_meant(const struct wb_calibrate_settings *settings)
{
    struct wb_calibrate_settings meant = *settings;
    if (!(meant.yield_point > 0.0))
        meant.yield_point = meant.elastic_zone;
    return meant;
}

bool wb_calibrate_is_complete(enum wb_calibrate_end end)
{
    return end == WB_CALIBRATE_SIZE || end == WB_CALIBRATE_ERROR || end == WB_CALIBRATE_REFINED;
}

const char *wb_calibrate_end_text(enum wb_calibrate_end end)
{
    static const char *const texts[] = {
        [WB_CALIBRATE_SIZE] = "the simplex became small",
        [WB_CALIBRATE_ERROR] = "the error became small",
        [WB_CALIBRATE_REFINED] = "Gauss-Newton steps converged",
        [WB_CALIBRATE_ITERATIONS] = "the iterations ran out",
        [WB_CALIBRATE_STOPPED] = "stopped by the caller",
    };
    return texts[end];
}

static void silence_gsl(void)
{
    gsl_set_error_handler_off();
}

/* The grid of these settings. */
static struct wb_curve_grid grid_of(const struct wb_calibrate_settings *settings)
{
    return (struct wb_curve_grid){.step = settings->step,
                                  .force_step = settings->force_step,
                                  .largest_deflection = settings->largest_deflection};
}

static double yield_point(const struct wb_calibrate_settings *settings)
{
    return wb_calibrate_settings_meant(settings).yield_point;
}

static struct wb_computed_settings computed_settings(const struct wb_calibrate_settings *settings,
                                                     struct wb_reason *why)
{
    return (struct wb_computed_settings){settings->straight, settings->n_elements,
                                         settings->n_fibres, why};
}

/* Distance of a point from the domain, 0 inside. */
static double violation(double strength_ratio, double exponent)
{
    double outside = 0.0;
    outside += fmax(0.0, SMALLEST_STRENGTH_RATIO - strength_ratio);
    outside += fmax(0.0, strength_ratio / LARGEST_STRENGTH_RATIO - 1.0);
    outside += fmax(0.0, SMALLEST_EXPONENT - exponent);
    outside += fmax(0.0, exponent - LARGEST_EXPONENT);
    return outside;
}

/* E_L2 over F_max sqrt(delta_max), or its equivalent for follower tests, at (K/K0, n/n0). Always
 * finite: a penalty grows with the distance from the domain, and with the part of the curve that a
 * beam did not reach, so that the simplex returns to the domain. */
static double evaluate(const gsl_vector *at, void *parameters)
{
    struct objective *const objective = parameters;
    const struct wb_curve *const curve = objective->curve;
    const double ratio = gsl_vector_get(at, 0);
    const double exponent = gsl_vector_get(at, 1) * objective->first_exponent;
    const double outside = violation(ratio, exponent);
    if (outside > 0.0 || !isfinite(outside))
        return PENALTY * (2.0 + fmin(outside, 1e6));
    objective->material.strength_coefficient = ratio * objective->first_strength;
    objective->material.hardening_exponent = exponent;
    int reached = 0;
    const enum wb_status status =
        wb_computed_curve(objective->computed, &objective->material, objective->n, curve->step,
                          objective->value, &reached);
    objective->evaluations++;
    if (status != WB_OK)
        objective->status = status;
    if (status != WB_OK || reached < objective->n) {
        objective->failed++;
        return PENALTY * (2.0 - (double)reached / objective->n);
    }
    return wb_errors_relative_l2(objective->n, curve->step, curve->value, objective->value,
                                 wb_curve_scale(curve));
}

static void add_step(struct wb_calibrate_result *result, const struct objective *objective,
                     const gsl_vector *best, double error, double size)
{
    const size_t n = (size_t)result->n_path++;
    result->path = wb_memory_resize(result->path, n + 1, sizeof *result->path);
    result->path[n] = (struct wb_calibrate_step){
        .strength_coefficient = gsl_vector_get(best, 0) * objective->first_strength,
        .hardening_exponent = gsl_vector_get(best, 1) * objective->first_exponent,
        .error = error,
        .size = size,
    };
}

/* Iterates one simplex until its size or the error is small, the iterations are exhausted, or the
 * caller stops it. */
static enum wb_status iterate(struct wb_calibrate_result *result, struct objective *objective,
                              gsl_multimin_fminimizer *minimizer, double first_error,
                              const struct wb_calibrate_settings *settings)
{
    const gsl_vector *const best = gsl_multimin_fminimizer_x(minimizer);
    for (int i = 0;; i++) {
        const double size = gsl_multimin_fminimizer_size(minimizer);
        /* GSL has no minimum before the first iteration. */
        const double error = i == 0 ? first_error : gsl_multimin_fminimizer_minimum(minimizer);
        if (objective->status != WB_OK)
            return objective->status;
        add_step(result, objective, best, error, size);
        const bool is_stopped =
            settings->progress &&
            !settings->progress(settings->progress_context, objective->evaluations, error, size);
        const bool is_small = error < settings->error_tolerance;
        if (is_stopped || is_small || size < settings->size_tolerance ||
            i >= settings->max_iterations) {
            result->end = is_stopped                        ? WB_CALIBRATE_STOPPED
                          : is_small                        ? WB_CALIBRATE_ERROR
                          : size < settings->size_tolerance ? WB_CALIBRATE_SIZE
                                                            : WB_CALIBRATE_ITERATIONS;
            return WB_OK;
        }
        /* GSL fails only for a contraction to a non-finite value, which evaluate() never
         * returns. */
        if (gsl_multimin_fminimizer_iterate(minimizer) != GSL_SUCCESS)
            return wb_fail_to(objective->why, WB_ERR_CONVERGENCE, "the simplex could not continue");
    }
}

/* Runs one simplex from (K/K0, n/n0) = `at`, with edges of 5 % of each; `at` receives the
 * optimum. */
static enum wb_status minimise(struct wb_calibrate_result *result, struct objective *objective,
                               double at[2], const struct wb_calibrate_settings *settings)
{
    gsl_multimin_fminimizer *const minimizer =
        wb_memory_need(gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 2));
    double edge[2] = {SIMPLEX_STEP * at[0], SIMPLEX_STEP * at[1]};
    const gsl_vector_view start = gsl_vector_view_array(at, 2);
    const gsl_vector_view edges = gsl_vector_view_array(edge, 2);
    gsl_multimin_function function = {evaluate, 2, objective};
    enum wb_status status = WB_OK;
    const double first_error = evaluate(&start.vector, objective);
    if (gsl_multimin_fminimizer_set(minimizer, &function, &start.vector, &edges.vector) !=
        GSL_SUCCESS)
        status =
            wb_fail_to(objective->why, WB_ERR_CONVERGENCE, "the first simplex could not be made");
    if (status == WB_OK)
        status = iterate(result, objective, minimizer, first_error, settings);
    if (status == WB_OK) {
        const gsl_vector *const best = gsl_multimin_fminimizer_x(minimizer);
        at[0] = gsl_vector_get(best, 0);
        at[1] = gsl_vector_get(best, 1);
        if (result->path[result->n_path - 1].error >= PENALTY &&
            result->end != WB_CALIBRATE_STOPPED)
            status = wb_fail_to(objective->why, WB_ERR_CONVERGENCE,
                                "wire '%s': the beam does not converge anywhere near the first "
                                "guess (K0 = %.4g MPa, n0 = %.4g)",
                                result->info.wire, objective->first_strength / WB_MPA,
                                objective->first_exponent);
    }
    gsl_multimin_fminimizer_free(minimizer);
    return status;
}

/* Checks that the force at the end is below the elastic one. */
static enum wb_status check_share(const struct objective *objective,
                                  const struct wb_test_info *info)
{
    const struct wb_curve *const curve = objective->curve;
    const double predicted = objective->value[curve->n - 1];
    const double share = curve->force[curve->n - 1] / predicted;
    if (predicted > 0.0 && share > ELASTIC_SHARE)
        return wb_fail_to(
            objective->why, WB_ERR_DATA,
            "wire '%s': yield is not reached: at %.2f mm the force is still %.0f %% of "
            "the linear elastic prediction's",
            info->wire, curve->max_deflection / WB_MM, 100.0 * share);
    return WB_OK;
}

/* Checks that the deflection under a follower force differs from the elastic one somewhere; at the
 * end, curled up, the two may be equal again. */
static enum wb_status check_leaves(const struct objective *objective,
                                   const struct wb_test_info *info)
{
    const struct wb_curve *const curve = objective->curve;
    double separation = 0.0, highest = 0.0;
    for (int i = 0; i < curve->n; i++) {
        separation = fmax(separation, fabs(curve->deflection[i] - objective->value[i]));
        highest = fmax(highest, fabs(objective->value[i]));
    }
    if (separation < (1.0 - ELASTIC_SHARE) * highest)
        return wb_fail_to(objective->why, WB_ERR_DATA,
                          "wire '%s': yield is not reached: up to %.4g N the deflection is within "
                          "%.2f mm of the linear elastic prediction's",
                          info->wire, curve->max_force, separation / WB_MM);
    return WB_OK;
}

/* Rejects a test that follows the linear elastic prediction to its end. */
static enum wb_status check_yielded(struct objective *objective, const struct wb_test_info *info)
{
    struct wb_material elastic = objective->material;
    const struct wb_curve *const curve = objective->curve;
    int reached = 0;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    WB_TRY(wb_computed_curve(objective->computed, &elastic, curve->n, curve->step, objective->value,
                             &reached));
    objective->evaluations++;
    if (reached < curve->n)
        return WB_OK;
    return curve->is_follower ? check_leaves(objective, info) : check_share(objective, info);
}

static void take_optimum(struct wb_calibrate_result *result, const struct objective *objective,
                         const double at[2])
{
    result->material = objective->material;
    result->material.strength_coefficient = at[0] * objective->first_strength;
    result->material.hardening_exponent = at[1] * objective->first_exponent;
    result->evaluations = objective->evaluations;
    result->failed_evaluations = objective->failed;
}

/* Points up to the largest deflection of a follower test; all points otherwise. */
static int rising_points(const struct wb_curve *curve)
{
    int n = curve->n;
    while (curve->is_follower && n > 2 && curve->deflection[n - 1] < curve->max_deflection)
        n--;
    return n;
}

/* Gauss-Newton steps from (K/K0, n/n0) = `at`, with a tenth of the beam runs of a simplex. `at`
 * changes only if they converge. */
static enum wb_status refine_by_gauss_newton(struct wb_calibrate_result *result,
                                             struct objective *objective, double at[2],
                                             bool *converged)
{
    struct wb_material material = objective->material;
    material.strength_coefficient = at[0] * objective->first_strength;
    material.hardening_exponent = at[1] * objective->first_exponent;
    const struct wb_material before = material;
    WB_TRY(wb_refit_run(&material, converged, objective->computed, objective->curve,
                        &objective->evaluations));
    const double to[2] = {material.strength_coefficient / objective->first_strength,
                          material.hardening_exponent / objective->first_exponent};
    *converged = *converged && violation(to[0], material.hardening_exponent) == 0.0;
    if (!*converged)
        return WB_OK;
    if (material.strength_coefficient != before.strength_coefficient)
        at[0] = to[0];
    if (material.hardening_exponent != before.hardening_exponent)
        at[1] = to[1];
    const gsl_vector_const_view there = gsl_vector_const_view_array(at, 2);
    add_step(result, objective, &there.vector, evaluate(&there.vector, objective),
             result->path[result->n_path - 1].size);
    if (result->end == WB_CALIBRATE_ITERATIONS)
        result->end = WB_CALIBRATE_REFINED;
    return WB_OK;
}

/* Nelder-Mead, then again from the optimum. If a follower test goes beyond its largest deflection,
 * the first search ends there: the tip of a curled wire comes down to where that of a much stiffer
 * wire is still going up, and the error has a ridge between the two. */
static enum wb_status optimise(struct wb_calibrate_result *result, struct objective *objective,
                               const struct wb_calibrate_settings *settings)
{
    double at[2] = {1.0, 1.0};
    objective->n = rising_points(objective->curve);
    if (objective->n < objective->curve->n)
        WB_TRY(minimise(result, objective, at, settings));
    objective->n = objective->curve->n;
    if (result->n_path == 0 || result->end != WB_CALIBRATE_STOPPED)
        WB_TRY(minimise(result, objective, at, settings));
    result->start_of_restart = result->n_path;
    if (settings->restart && result->end != WB_CALIBRATE_STOPPED &&
        result->end != WB_CALIBRATE_ERROR) {
        const double before[2] = {at[0], at[1]};
        bool converged;
        WB_TRY(refine_by_gauss_newton(result, objective, at, &converged));
        if (!converged)
            WB_TRY(minimise(result, objective, at, settings));
        result->restarted = true;
        result->restart_moved = fmax(fabs(at[0] / before[0] - 1.0), fabs(at[1] / before[1] - 1.0));
    }
    take_optimum(result, objective, at);
    return WB_OK;
}

/* --- effect of bows ---
 *
 * Eqs. 10 and 11 assume a straight wire; for a sample with a bow their modulus and yield stress are
 * biased. The bias is found by applying them to curves that are computed for the same samples with
 * a known material.
 */

struct samples {
    const struct wb_dataset *const *datasets; /* (n) */
    int n;
    const struct wb_curve *curve; /* their average, whose grid is used */
    const struct wb_calibrate_settings *settings;
    const struct wb_computed_settings *how;
};

/* Adds 1/n of a sample's computed curve to `mean`. */
static enum wb_status add_sample(double *mean, double *value, const struct samples *samples,
                                 const struct wb_test_info *info,
                                 const struct wb_material *material, struct wb_reason *why)
{
    const struct wb_curve *const curve = samples->curve;
    struct wb_computed *computed;
    int reached = 0;
    WB_TRY(wb_computed_create(&computed, info, material, samples->how));
    enum wb_status status =
        wb_computed_curve(computed, material, curve->n, curve->step, value, &reached);
    wb_computed_destroy(computed);
    if (status == WB_OK && reached < curve->n)
        status = wb_fail_to(why, WB_ERR_CONVERGENCE,
                            "wire '%s', sample %d: the beam converges only up to %.3g of the "
                            "curve, so the effect of its bow on E cannot be determined",
                            info->wire, info->sample, (double)reached / curve->n);
    for (int i = 0; status == WB_OK && i < curve->n; i++)
        mean[i] += value[i] / samples->n;
    return status;
}

/* Applies eqs. 10 and 11 to the mean of the curves computed with `material` for the samples, each
 * with its own natural shape. The bows change E by the ratio of this modulus to the material's, and
 * sigma_Y likewise. *evaluations is increased by the number of beam runs. */
static enum wb_status guess_of_computed(struct wb_first_guess *guess, const struct samples *samples,
                                        const struct wb_material *material, int *evaluations,
                                        struct wb_reason *why)
{
    const size_t points = (size_t)samples->curve->n;
    double *const mean = wb_memory_new(2 * points, sizeof *mean);
    enum wb_status status = WB_OK;
    for (int i = 0; status == WB_OK && i < samples->n; i++) {
        status =
            add_sample(mean, mean + points, samples, &samples->datasets[i]->info, material, why);
        ++*evaluations;
    }
    if (status == WB_OK) {
        struct wb_curve computed = *samples->curve;
        computed.value = mean;
        status = wb_first_guess_run(guess, &computed, &samples->datasets[0]->info,
                                    samples->settings->elastic_zone, yield_point(samples->settings),
                                    why);
    }
    free(mean);
    return status;
}

/* Multiplies E and sigma_Y, unless given, by the ratio of two closed forms. */
static void scale_closed_forms(struct wb_material *material, const struct wb_first_guess *measured,
                               const struct wb_first_guess *computed,
                               const struct wb_calibrate_settings *settings)
{
    if (settings->youngs_modulus <= 0.0)
        material->youngs_modulus *= measured->youngs_modulus / computed->youngs_modulus;
    if (settings->yield_stress <= 0.0)
        material->yield_stress *= measured->yield_stress / computed->yield_stress;
}

/* Removes the bias of eqs. 10 and 11 by the bows from E and sigma_Y, by the ratio of measured to
 * computed values, and fits K and n again from their current values. */
static enum wb_status correct_for_bows(struct wb_calibrate_result *result,
                                       struct objective *objective, const struct samples *samples,
                                       const struct wb_first_guess *measured)
{
    const struct wb_calibrate_settings *const settings = samples->settings;
    for (int pass = 0; pass < BOW_PASSES && result->end != WB_CALIBRATE_STOPPED; pass++) {
        struct wb_first_guess computed;
        double at[2] = {1.0, 1.0};
        WB_TRY(guess_of_computed(&computed, samples, &result->material, &objective->evaluations,
                                 objective->why));
        objective->material = result->material;
        scale_closed_forms(&objective->material, measured, &computed, settings);
        objective->first_strength = result->material.strength_coefficient;
        objective->first_exponent = result->material.hardening_exponent;
        bool converged;
        WB_TRY(refine_by_gauss_newton(result, objective, at, &converged));
        if (!converged)
            WB_TRY(minimise(result, objective, at, settings));
        take_optimum(result, objective, at);
    }
    result->bow_corrected = true;
    return WB_OK;
}

/* Errors of the final law on every point of the grid: eqs. 18 and 19. */
static enum wb_status compute_errors(struct wb_calibrate_result *result,
                                     struct objective *objective)
{
    const struct wb_curve *const curve = objective->curve;
    int reached = 0;
    WB_TRY(wb_computed_curve(objective->computed, &result->material, curve->n, curve->step,
                             objective->value, &reached));
    result->evaluations++;
    wb_errors_curve(curve->n, curve->value, objective->value, wb_curve_scale(curve),
                    objective->value);
    result->rms = wb_errors_rms(curve->n, objective->value);
    result->max_error = wb_errors_largest(curve->n, objective->value);
    result->scatter_rms = wb_curve_scatter(curve);
    result->n_samples = curve->n_samples;
    result->max_force = curve->max_force;
    result->max_deflection = curve->max_deflection;
    return WB_OK;
}

static double bow_spread(const struct wb_dataset *const *datasets, int n)
{
    double known = 0.0, mean = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++) {
        if (datasets[i]->info.n_natural_shape == 0)
            continue;
        known += 1.0;
        mean += wb_dataset_bow(&datasets[i]->info);
    }
    for (int i = 0; i < n; i++) {
        const double off = wb_dataset_bow(&datasets[i]->info) - mean / fmax(known, 1.0);
        squares += datasets[i]->info.n_natural_shape > 0 ? off * off : 0.0;
    }
    return known > 1.0 ? sqrt(squares / (known - 1.0)) : 0.0;
}

int wb_calibrate_remarks(const struct wb_calibrate_result *result,
                         const char *remarks[WB_CALIBRATE_MOST_REMARKS])
{
    int n = 0;
    const struct wb_material *const m = &result->material;
    const double ratio = m->strength_coefficient / result->first_strength_coefficient;
    const double large = LARGE_BOW * result->info.length;
    if (!result->bow_corrected &&
        (fabs(wb_dataset_bow(&result->info)) > large || result->bow_spread > large))
        remarks[n++] =
            "the uncertainty excludes the bias that specimen bow causes in eqs. 10 and 11";
    if (m->hardening_exponent > 1.0)
        remarks[n++] = "n is above 1: the stress increases progressively with the strain, unlike "
                       "in any metal; K and n are only fit parameters";
    if (m->hardening_exponent < SMALLEST_EXPONENT * (1.0 + AT_BOUND) ||
        m->hardening_exponent > LARGEST_EXPONENT * (1.0 - AT_BOUND) ||
        ratio < SMALLEST_STRENGTH_RATIO * (1.0 + AT_BOUND) ||
        ratio > LARGEST_STRENGTH_RATIO * (1.0 - AT_BOUND))
        remarks[n++] = "K or n is at a bound of the search: no optimum was found";
    return n;
}

/* --- uncertainties --- */

/* What the jackknife passes on. */
struct leaving_out {
    const struct wb_calibrate_settings *settings;
    int *evaluations;
};

/* E and sigma_Y from eqs. 10 and 11 of the samples' own curve; K and n are fitted starting from
 * those of `material`. */
static enum wb_status refit_curve(const struct samples *samples, struct wb_material *material,
                                  bool *converged, int *evaluations, struct wb_reason *why)
{
    const struct wb_calibrate_settings *const settings = samples->settings;
    struct wb_computed *computed;
    struct wb_test_info info;
    struct wb_first_guess guess;
    wb_curve_mean_info(samples->datasets, samples->n, &info);
    WB_TRY(wb_first_guess_run(&guess, samples->curve, &info, settings->elastic_zone,
                              yield_point(settings), why));
    struct wb_first_guess before = {.youngs_modulus = material->youngs_modulus,
                                    .yield_stress = material->yield_stress};
    if (settings->bow_corrected && !settings->straight)
        WB_TRY(guess_of_computed(&before, samples, material, evaluations, why));
    scale_closed_forms(material, &guess, &before, settings);
    WB_TRY(wb_computed_create(&computed, &info, material, samples->how));
    const enum wb_status status =
        wb_refit_run(material, converged, computed, samples->curve, evaluations);
    wb_computed_destroy(computed);
    return status;
}

static enum wb_status refit_samples(void *context, const struct wb_dataset *const *datasets, int n,
                                    struct wb_material *material, bool *converged,
                                    struct wb_reason *why)
{
    const struct leaving_out *const how = context;
    const struct wb_curve_grid grid = grid_of(how->settings);
    const struct wb_computed_settings computed = computed_settings(how->settings, why);
    struct wb_curve curve;
    *converged = false;
    WB_TRY(wb_curve_average_on(&curve, datasets, n, &grid, why));
    const struct samples samples = {datasets, n, &curve, how->settings, &computed};
    const enum wb_status status = refit_curve(&samples, material, converged, how->evaluations, why);
    wb_curve_release(&curve);
    return status;
}

enum wb_status wb_calibrate_deviations(struct wb_calibrate_result *result,
                                       const struct wb_dataset *const *datasets, int n,
                                       const struct wb_calibrate_settings *settings,
                                       struct wb_reason *why)
{
    struct leaving_out how = {settings, &result->evaluations};
    const struct wb_jackknife_refit refit = {refit_samples, &how};
    return wb_jackknife_run(result->deviation, datasets, n, &result->material, &refit, why);
}

/* --- calibration --- */

static enum wb_status calibrate_curve(struct wb_calibrate_result *result,
                                      const struct wb_curve *curve,
                                      const struct wb_dataset *const *datasets, int n,
                                      const struct wb_calibrate_settings *settings,
                                      struct wb_reason *why)
{
    struct wb_first_guess guess;
    wb_curve_mean_info(datasets, n, &result->info);
    wb_curve_warn_unknown_shapes(datasets, n);
    result->bow_spread = bow_spread(datasets, n);
    WB_TRY(wb_first_guess_run(&guess, curve, &result->info, settings->elastic_zone,
                              yield_point(settings), why));
    result->first_strength_coefficient = guess.strength_coefficient;
    result->first_hardening_exponent = guess.hardening_exponent;
    struct objective objective = {
        .curve = curve,
        .material = {.hardening = WB_HARDENING_ISOTROPIC_POWER,
                     .youngs_modulus = guess.youngs_modulus,
                     .poissons_ratio = result->info.poissons_ratio,
                     .yield_stress = guess.yield_stress,
                     .strength_coefficient = guess.strength_coefficient,
                     .hardening_exponent = guess.hardening_exponent},
        .first_strength = guess.strength_coefficient,
        .first_exponent = guess.hardening_exponent,
        .why = why,
    };
    if (settings->youngs_modulus > 0.0)
        objective.material.youngs_modulus = settings->youngs_modulus;
    if (settings->yield_stress > 0.0)
        objective.material.yield_stress = settings->yield_stress;
    const struct wb_computed_settings how = computed_settings(settings, why);
    objective.value = wb_memory_new((size_t)curve->n, sizeof *objective.value);
    enum wb_status status =
        wb_computed_create(&objective.computed, &result->info, &objective.material, &how);
    if (status == WB_OK)
        status = check_yielded(&objective, &result->info);
    if (status == WB_OK)
        status = optimise(result, &objective, settings);
    if (status == WB_OK && settings->bow_corrected && !settings->straight) {
        const struct samples samples = {datasets, n, curve, settings, &how};
        status = correct_for_bows(result, &objective, &samples, &guess);
    }
    if (status == WB_OK)
        status = compute_errors(result, &objective);
    if (status == WB_OK)
        status = wb_scatter_residual(&result->residual_scatter_rms, datasets, n, curve,
                                     &result->material, &how);
    wb_computed_destroy(objective.computed);
    free(objective.value);
    if (status == WB_OK && result->end != WB_CALIBRATE_STOPPED)
        status = wb_calibrate_deviations(result, datasets, n, settings, why);
    return status;
}

enum wb_status wb_calibrate_run(struct wb_calibrate_result *result,
                                const struct wb_dataset *const *datasets, int n,
                                const struct wb_calibrate_settings *settings, struct wb_reason *why)
{
    /* GSL's default handler aborts the program. */
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, silence_gsl);
    const double started = wb_progress_thread_cpu();
    WB_TRY(wb_setting_check(&wb_calibrate_table, settings, why));
    struct wb_calibrate_result made = {0};
    struct wb_curve curve;
    for (int k = 0; k < 4; k++)
        made.deviation[k] = (double)NAN;
    const struct wb_curve_grid grid = grid_of(settings);
    WB_TRY(wb_curve_average_on(&curve, datasets, n, &grid, why));
    const enum wb_status status = calibrate_curve(&made, &curve, datasets, n, settings, why);
    wb_curve_release(&curve);
    made.cpu_s = wb_progress_thread_cpu() - started;
    if (status == WB_OK)
        *result = made;
    else
        wb_calibrate_result_release(&made);
    return status;
}

void wb_calibrate_result_release(struct wb_calibrate_result *result)
{
    free(result->path);
    result->path = NULL;
    result->n_path = 0;
}
