#include "analysis/jackknife.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/bow_correction.h"
#include "analysis/computed.h"
#include "analysis/errors.h"
#include "analysis/first_guess.h"
#include "base/log.h"

#define WB_LOG_DOMAIN "jackknife"

/* Steps of ln K and n for the slopes. */
#define SLOPE_STEP 0.01
/* A refit is settled when ln K and n move less than this. */
#define SETTLED 1e-3
#define MOST_STEPS 12
/* So much of Levenberg's damping leaves the step as good as Gauss and Newton's. */
#define FIRST_DAMPING 1e-3
/* Largest change of ln K and n in one step. */
#define LARGEST_STEP 0.5
/* Where n may lie; K only needs to be positive, which its logarithm sees to. */
#define SMALLEST_EXPONENT 0.01
#define LARGEST_EXPONENT 1.5

/* One fit with a sample left out. */
struct refit {
    struct wb_computed *computed;
    struct wb_curve curve;
    struct wb_material material;
    /* (curve.n) computed values, their slopes by ln K and by n, workspace; one block, owned by
     * value */
    double *value, *by_strength, *by_exponent, *previous;
    int *evaluations;
};

static enum wb_status run(struct refit *refit, double log_strength, double exponent, double *value,
                          bool *complete)
{
    struct wb_material material = refit->material;
    int reached;
    material.strength_coefficient *= exp(log_strength);
    material.hardening_exponent += exponent;
    WB_TRY(wb_computed_curve(refit->computed, &material, refit->curve.n, refit->curve.step, value,
                             &reached));
    ++*refit->evaluations;
    *complete = reached == refit->curve.n;
    return WB_OK;
}

/* Slopes by ln K and n at refit->material by forward differences; refit->value is there already. */
static enum wb_status find_slopes(struct refit *refit, bool *complete)
{
    WB_TRY(run(refit, SLOPE_STEP, 0.0, refit->by_strength, complete));
    if (*complete)
        WB_TRY(run(refit, 0.0, SLOPE_STEP, refit->by_exponent, complete));
    for (int i = 0; i < refit->curve.n; i++) {
        refit->by_strength[i] = (refit->by_strength[i] - refit->value[i]) / SLOPE_STEP;
        refit->by_exponent[i] = (refit->by_exponent[i] - refit->value[i]) / SLOPE_STEP;
    }
    return WB_OK;
}

/* Gauss-Newton step of (ln K, n) with Levenberg's `damping`; false when the two cannot be told
 * apart. */
static bool newton_step(const struct refit *refit, double damping, double step[2])
{
    double aa = 0.0, ab = 0.0, bb = 0.0, ar = 0.0, br = 0.0;
    for (int i = 0; i < refit->curve.n; i++) {
        const double a = refit->by_strength[i], b = refit->by_exponent[i];
        const double residual = refit->curve.value[i] - refit->value[i];
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ar += a * residual;
        br += b * residual;
    }
    aa *= 1.0 + damping;
    bb *= 1.0 + damping;
    const double determinant = aa * bb - ab * ab;
    if (!(determinant > 1e-10 * aa * bb))
        return false;
    step[0] = (ar * bb - br * ab) / determinant;
    step[1] = (br * aa - ar * ab) / determinant;
    const double largest = fmax(fabs(step[0]), fabs(step[1]));
    if (!isfinite(largest))
        return false;
    if (largest > LARGEST_STEP) {
        step[0] *= LARGEST_STEP / largest;
        step[1] *= LARGEST_STEP / largest;
    }
    const double exponent = refit->material.hardening_exponent;
    step[1] = fmin(fmax(step[1], SMALLEST_EXPONENT - exponent), LARGEST_EXPONENT - exponent);
    return true;
}

static double curve_error(const struct refit *refit, bool complete)
{
    return complete
               ? wb_errors_l2(refit->curve.n, refit->curve.step, refit->curve.value, refit->value)
               : HUGE_VAL;
}

/* Refits K and n of refit->material; *settled tells whether it worked. */
static enum wb_status refit_hardening(struct refit *refit, bool *settled)
{
    double damping = FIRST_DAMPING, step[2];
    bool complete;
    *settled = false;
    WB_TRY(run(refit, 0.0, 0.0, refit->value, &complete));
    double best = curve_error(refit, complete);
    if (complete)
        WB_TRY(find_slopes(refit, &complete));
    if (!complete)
        return WB_OK;
    for (int i = 0; i < MOST_STEPS && !*settled; i++) {
        double *const previous = refit->previous;
        if (!newton_step(refit, damping, step))
            return WB_OK;
        /* The curve of the last accepted point is kept until the trial proves better. */
        memcpy(previous, refit->value, (size_t)refit->curve.n * sizeof *previous);
        WB_TRY(run(refit, step[0], step[1], refit->value, &complete));
        const double error = curve_error(refit, complete);
        const bool is_small = fmax(fabs(step[0]), fabs(step[1])) < SETTLED;
        if (!(error < best)) {
            /* A step is small by damping too; only an undamped one that gains nothing has arrived.
             */
            *settled = is_small && damping <= FIRST_DAMPING;
            memcpy(refit->value, previous, (size_t)refit->curve.n * sizeof *previous);
            damping *= 10.0;
            continue;
        }
        *settled = is_small && damping <= FIRST_DAMPING;
        best = error;
        damping *= 0.1;
        refit->material.strength_coefficient *= exp(step[0]);
        refit->material.hardening_exponent += step[1];
        if (!*settled)
            WB_TRY(find_slopes(refit, &complete));
        if (!complete)
            return WB_OK;
    }
    return WB_OK;
}

/* Fills a refit whose curve is there; E and sigma_Y anew. */
static enum wb_status prepare(struct refit *refit, const struct wb_dataset *const *others, int n,
                              const struct wb_calibrate_settings *settings)
{
    struct wb_test_info info;
    struct wb_first_guess guess;
    const double yield_point =
        settings->yield_point > 0.0 ? settings->yield_point : settings->elastic_zone;
    const size_t points = (size_t)refit->curve.n;
    wb_curve_mean_info(others, n, &info);
    WB_TRY(wb_first_guess_run(&guess, &refit->curve, &info, settings->elastic_zone, yield_point));
    struct wb_first_guess computed = {.youngs_modulus = refit->material.youngs_modulus,
                                      .yield_stress = refit->material.yield_stress};
    if (settings->bow_corrected && !settings->straight) {
        const struct wb_bow_samples samples = {others, n, &refit->curve};
        WB_TRY(wb_bow_correction_guess(&computed, &samples, &refit->material, settings,
                                       refit->evaluations));
    }
    if (settings->youngs_modulus <= 0.0)
        refit->material.youngs_modulus *= guess.youngs_modulus / computed.youngs_modulus;
    if (settings->yield_stress <= 0.0)
        refit->material.yield_stress *= guess.yield_stress / computed.yield_stress;
    refit->value = calloc(4 * points, sizeof *refit->value);
    if (!refit->value)
        return wb_fail(WB_ERR_MEMORY, "no memory for %zu points", points);
    refit->by_strength = refit->value + points;
    refit->by_exponent = refit->value + 2 * points;
    refit->previous = refit->value + 3 * points;
    const struct wb_computed_settings how = {settings->straight, settings->n_elements,
                                             settings->n_fibres};
    return wb_computed_create(&refit->computed, &info, &refit->material, &how);
}

/* Calibrates all samples but one, from the optimum of all. */
static enum wb_status leave_out(struct wb_material *material, bool *settled, int *evaluations,
                                const struct wb_dataset *const *others, int n,
                                const struct wb_calibrate_settings *settings)
{
    struct refit refit = {.material = *material, .evaluations = evaluations};
    *settled = false;
    const struct wb_curve_grid grid = wb_calibrate_grid(settings);
    WB_TRY(wb_curve_average_on(&refit.curve, others, n, &grid));
    enum wb_status status = prepare(&refit, others, n, settings);
    if (status == WB_OK)
        status = refit_hardening(&refit, settled);
    *material = refit.material;
    wb_computed_destroy(refit.computed);
    free(refit.value);
    wb_curve_release(&refit.curve);
    return status;
}

/* Jackknife deviation of n values. */
static double spread(const double *values, int n)
{
    double mean = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++)
        mean += values[i] / n;
    for (int i = 0; i < n; i++)
        squares += (values[i] - mean) * (values[i] - mean);
    return sqrt((n - 1.0) / n * squares);
}

static enum wb_status leave_each_out(double deviation[4], const struct wb_dataset *const *datasets,
                                     int n, const struct wb_calibrate_settings *settings,
                                     const struct wb_material *optimum, int *evaluations)
{
    enum wb_status status = WB_OK;
    bool all_settled = true;
    const struct wb_dataset **const others = malloc((size_t)n * sizeof(struct wb_dataset *));
    double *const values = malloc(4 * (size_t)n * sizeof *values);
    if (!others || !values)
        status = wb_fail(WB_ERR_MEMORY, "no memory for %d samples", n);
    for (int i = 0; status == WB_OK && i < n; i++) {
        struct wb_material material = *optimum;
        int kept = 0;
        bool settled;
        for (int k = 0; k < n; k++) {
            if (k != i)
                others[kept++] = datasets[k];
        }
        status = leave_out(&material, &settled, evaluations, others, kept, settings);
        all_settled = all_settled && settled;
        values[i] = material.youngs_modulus;
        values[n + i] = material.yield_stress;
        values[2 * n + i] = log(material.strength_coefficient / optimum->strength_coefficient);
        values[3 * n + i] = material.hardening_exponent;
    }
    for (int k = 0; status == WB_OK && k < 4; k++)
        deviation[k] = k < 2 || all_settled ? spread(values + k * n, n) : (double)NAN;
    free(others);
    free(values);
    return status;
}

enum wb_status wb_jackknife_run(double deviation[4], const struct wb_dataset *const *datasets,
                                int n, const struct wb_calibrate_settings *settings,
                                const struct wb_material *optimum, int *evaluations)
{
    for (int k = 0; k < 4; k++)
        deviation[k] = (double)NAN;
    if (n < 2)
        return WB_OK;
    /* What is refused here is refused of a part of the samples: the calibration stands. */
    const enum wb_log_level before = wb_log_set_gravest(WB_LOG_WARNING);
    enum wb_status status = leave_each_out(deviation, datasets, n, settings, optimum, evaluations);
    wb_log_set_gravest(before);
    if (status != WB_OK && status != WB_ERR_DATA)
        return wb_fail(status, "wire '%s': the uncertainties could not be computed: %s",
                       datasets[0]->info.wire, wb_status_text(status));
    if (status == WB_ERR_DATA) {
        wb_warn("wire '%s': no uncertainties, because a sample left out makes the rest unusable",
                datasets[0]->info.wire);
        status = WB_OK;
    }
    return status;
}
