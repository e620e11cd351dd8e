#include "analysis/calibration/paper/refit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/errors.h"
#include "base/memory.h"

/* Step of ln K and of n in finite differences. */
#define SLOPE_STEP 0.01
/* Convergence: the step of ln K and n is below the first limit, or the expected relative decrease
 * of the sum of squares below the second. */
#define CONVERGED_STEP 1e-3
#define CONVERGED_DECREASE 1e-5
#define MOST_STEPS 12
/* Levenberg's damping at the start: the step is nearly that of Gauss-Newton. */
#define FIRST_DAMPING 1e-3
/* Largest change of ln K and n in one step. */
#define LARGEST_STEP 0.5
/* Range of n. K needs none: its logarithm is fitted. */
#define SMALLEST_EXPONENT 0.01
#define LARGEST_EXPONENT 1.5

struct refit {
    struct wb_computed *computed;
    const struct wb_curve *curve;
    struct wb_material material;
    /* (curve->n) each, in one block owned by `value`: computed values, their derivatives with
     * respect to ln K and n, workspace */
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
    WB_TRY(wb_computed_curve(refit->computed, &material, refit->curve->n, refit->curve->step, value,
                             &reached));
    ++*refit->evaluations;
    *complete = reached == refit->curve->n;
    return WB_OK;
}

/* Derivatives with respect to ln K and n at refit->material by forward differences; refit->value is
 * already computed. */
static enum wb_status find_slopes(struct refit *refit, bool *complete)
{
    WB_TRY(run(refit, SLOPE_STEP, 0.0, refit->by_strength, complete));
    if (*complete)
        WB_TRY(run(refit, 0.0, SLOPE_STEP, refit->by_exponent, complete));
    for (int i = 0; i < refit->curve->n; i++) {
        refit->by_strength[i] = (refit->by_strength[i] - refit->value[i]) / SLOPE_STEP;
        refit->by_exponent[i] = (refit->by_exponent[i] - refit->value[i]) / SLOPE_STEP;
    }
    return WB_OK;
}

/* Gauss-Newton step of (ln K, n) with Levenberg's `damping`, and the expected relative decrease of
 * the sum of squares; false if ln K and n have the same effect on the curve. */
static bool newton_step(const struct refit *refit, double damping, double step[2], double *expected)
{
    double aa = 0.0, ab = 0.0, bb = 0.0, ar = 0.0, br = 0.0, rr = 0.0;
    for (int i = 0; i < refit->curve->n; i++) {
        const double a = refit->by_strength[i], b = refit->by_exponent[i];
        const double residual = refit->curve->value[i] - refit->value[i];
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ar += a * residual;
        br += b * residual;
        rr += residual * residual;
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
    *expected = rr > 0.0 ? (ar * step[0] + br * step[1]) / rr : 0.0;
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
    return complete ? wb_errors_l2(refit->curve->n, refit->curve->step, refit->curve->value,
                                   refit->value)
                    : HUGE_VAL;
}

/* Fits K and n of refit->material. */
static enum wb_status refit_hardening(struct refit *refit, bool *converged)
{
    double damping = FIRST_DAMPING, step[2], expected;
    bool complete;
    *converged = false;
    WB_TRY(run(refit, 0.0, 0.0, refit->value, &complete));
    double best = curve_error(refit, complete);
    if (complete)
        WB_TRY(find_slopes(refit, &complete));
    if (!complete)
        return WB_OK;
    for (int i = 0; i < MOST_STEPS && !*converged; i++) {
        double *const previous = refit->previous;
        if (!newton_step(refit, damping, step, &expected))
            return WB_OK;
        /* Restored below if the step does not reduce the error. */
        memcpy(previous, refit->value, (size_t)refit->curve->n * sizeof *previous);
        WB_TRY(run(refit, step[0], step[1], refit->value, &complete));
        const double error = curve_error(refit, complete);
        /* A strongly damped step is always small: it does not show convergence. */
        const bool is_small =
            damping <= FIRST_DAMPING &&
            (fmax(fabs(step[0]), fabs(step[1])) < CONVERGED_STEP || expected < CONVERGED_DECREASE);
        if (!(error < best)) {
            *converged = is_small;
            memcpy(refit->value, previous, (size_t)refit->curve->n * sizeof *previous);
            damping *= 10.0;
            continue;
        }
        *converged = is_small;
        best = error;
        damping *= 0.1;
        refit->material.strength_coefficient *= exp(step[0]);
        refit->material.hardening_exponent += step[1];
        if (!*converged)
            WB_TRY(find_slopes(refit, &complete));
        if (!complete)
            return WB_OK;
    }
    return WB_OK;
}

enum wb_status wb_refit_run(struct wb_material *material, bool *converged,
                            struct wb_computed *computed, const struct wb_curve *curve,
                            int *evaluations)
{
    const size_t points = (size_t)curve->n;
    double *const values = wb_memory_new(4 * points, sizeof *values);
    *converged = false;
    struct refit refit = {
        .computed = computed,
        .curve = curve,
        .material = *material,
        .value = values,
        .by_strength = values + points,
        .by_exponent = values + 2 * points,
        .previous = values + 3 * points,
        .evaluations = evaluations,
    };
    const enum wb_status status = refit_hardening(&refit, converged);
    *material = refit.material;
    free(values);
    return status;
}
