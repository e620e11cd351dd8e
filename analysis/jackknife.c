#include "analysis/jackknife.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/computed.h"
#include "analysis/errors.h"
#include "analysis/first_guess.h"

#define WB_LOG_DOMAIN "jackknife"

/* Steps of ln K and n for the slopes. */
#define SLOPE_STEP 0.01
/* A refit is settled when ln K and n move less than this. */
#define SETTLED 5e-4
#define MOST_STEPS 8
/* Largest change of ln K and n in one step. */
#define LARGEST_STEP 0.3
#define LARGEST_EXPONENT 1.5
#define SMALLEST_EXPONENT 0.01

/* The grid of all samples, and the slopes of the computed force there. */
struct slopes {
    int n;
    double *by_strength, *by_exponent; /* (n) dF/d ln K, dF/dn */
    double *force;                     /* (n) workspace */
};

/* One leave-one-out fit. */
struct refit {
    struct wb_computed *computed;
    struct wb_curve curve;
    struct wb_material material;
};

static enum wb_status run(struct wb_computed *computed, const struct wb_material *material,
                          const struct wb_curve *curve, double *force, int *evaluations,
                          bool *complete)
{
    int reached;
    WB_TRY(wb_computed_curve(computed, material, curve->n, curve->step, force, &reached));
    ++*evaluations;
    *complete = reached == curve->n;
    return WB_OK;
}

/* dF/d ln K and dF/dn at the optimum, by forward differences. */
static enum wb_status find_slopes(struct slopes *slopes, const struct wb_dataset *const *datasets,
                                  int n, const struct wb_calibrate_settings *settings,
                                  const struct wb_curve *curve, const struct wb_material *optimum,
                                  int *evaluations, bool *complete)
{
    struct wb_test_info info;
    wb_curve_mean_info(datasets, n, &info);
    const struct wb_computed_settings how = {settings->straight, settings->n_elements,
                                             settings->n_fibres};
    struct wb_computed *computed;
    WB_TRY(wb_computed_create(&computed, &info, optimum, &how));
    struct wb_material stronger = *optimum, straighter = *optimum;
    stronger.strength_coefficient *= exp(SLOPE_STEP);
    straighter.hardening_exponent += SLOPE_STEP;
    bool all[3] = {false, false, false};
    enum wb_status status = run(computed, optimum, curve, slopes->force, evaluations, &all[0]);
    if (status == WB_OK)
        status = run(computed, &stronger, curve, slopes->by_strength, evaluations, &all[1]);
    if (status == WB_OK)
        status = run(computed, &straighter, curve, slopes->by_exponent, evaluations, &all[2]);
    for (int i = 0; i < curve->n; i++) {
        slopes->by_strength[i] = (slopes->by_strength[i] - slopes->force[i]) / SLOPE_STEP;
        slopes->by_exponent[i] = (slopes->by_exponent[i] - slopes->force[i]) / SLOPE_STEP;
    }
    *complete = all[0] && all[1] && all[2];
    wb_computed_destroy(computed);
    return status;
}

/* Gauss-Newton step of (ln K, n) towards the curve; false when the two cannot be told apart. */
static bool newton_step(const struct slopes *slopes, const struct refit *refit, double step[2])
{
    double aa = 0.0, ab = 0.0, bb = 0.0, ar = 0.0, br = 0.0;
    const int n = refit->curve.n < slopes->n ? refit->curve.n : slopes->n;
    for (int i = 0; i < n; i++) {
        const double a = slopes->by_strength[i], b = slopes->by_exponent[i];
        const double residual = refit->curve.force[i] - slopes->force[i];
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ar += a * residual;
        br += b * residual;
    }
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
    return true;
}

/* Refits K and n of refit->material; *settled tells whether it worked. */
static enum wb_status refit_hardening(struct refit *refit, const struct slopes *slopes,
                                      int *evaluations, bool *settled)
{
    struct wb_material *const material = &refit->material;
    double step[2] = {0.0, 0.0}, best = HUGE_VAL;
    bool complete;
    *settled = false;
    for (int i = 0; i < MOST_STEPS && !*settled; i++) {
        WB_TRY(
            run(refit->computed, material, &refit->curve, slopes->force, evaluations, &complete));
        const double error = complete ? wb_errors_l2(refit->curve.n, refit->curve.step,
                                                     refit->curve.force, slopes->force)
                                      : HUGE_VAL;
        if (!(error < best * (1.0 + 1e-6))) {
            /* It got worse: go half the way back. */
            step[0] *= -0.5;
            step[1] *= -0.5;
            if (i == 0)
                return WB_OK;
        } else {
            best = error;
            if (!newton_step(slopes, refit, step))
                return WB_OK;
        }
        *settled = fmax(fabs(step[0]), fabs(step[1])) < SETTLED;
        const double exponent =
            fmin(fmax(material->hardening_exponent + step[1], SMALLEST_EXPONENT), LARGEST_EXPONENT);
        material->strength_coefficient *= exp(step[0]);
        /* Held at a limit there is nothing left to settle in that direction. */
        step[1] = exponent - material->hardening_exponent;
        material->hardening_exponent = exponent;
    }
    return WB_OK;
}

/* Calibrates all samples but one, from the optimum of all. */
static enum wb_status leave_out(struct wb_material *material, bool *settled, int *evaluations,
                                const struct wb_dataset *const *others, int n,
                                const struct wb_calibrate_settings *settings,
                                const struct slopes *slopes)
{
    struct refit refit = {.material = *material};
    struct wb_test_info info;
    struct wb_first_guess guess;
    const double yield_point =
        settings->yield_point > 0.0 ? settings->yield_point : settings->elastic_zone;
    *settled = false;
    enum wb_status status = wb_curve_average(&refit.curve, others, n, settings->step);
    if (status != WB_OK)
        return status;
    wb_curve_mean_info(others, n, &info);
    status = wb_first_guess_run(&guess, &refit.curve, &info, settings->elastic_zone, yield_point);
    if (status == WB_OK) {
        const struct wb_computed_settings how = {settings->straight, settings->n_elements,
                                                 settings->n_fibres};
        if (settings->youngs_modulus <= 0.0)
            refit.material.youngs_modulus = guess.youngs_modulus;
        if (settings->yield_stress <= 0.0)
            refit.material.yield_stress = guess.yield_stress;
        if (refit.curve.n > slopes->n)
            refit.curve.n = slopes->n;
        status = wb_computed_create(&refit.computed, &info, &refit.material, &how);
    }
    if (status == WB_OK)
        status = refit_hardening(&refit, slopes, evaluations, settled);
    *material = refit.material;
    wb_computed_destroy(refit.computed);
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
                                     const struct slopes *slopes, const struct wb_material *optimum,
                                     int *evaluations)
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
        status = leave_out(&material, &settled, evaluations, others, kept, settings, slopes);
        all_settled = all_settled && settled;
        values[i] = material.youngs_modulus;
        values[n + i] = material.yield_stress;
        values[2 * n + i] = material.strength_coefficient;
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
                                const struct wb_curve *curve, const struct wb_material *optimum,
                                int *evaluations)
{
    for (int k = 0; k < 4; k++)
        deviation[k] = (double)NAN;
    if (n < 2)
        return WB_OK;
    const size_t points = (size_t)curve->n;
    double *const memory = calloc(3 * points, sizeof *memory);
    if (!memory)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d points", curve->n);
    struct slopes slopes = {curve->n, memory, memory + points, memory + 2 * points};
    bool complete = false;
    enum wb_status status =
        find_slopes(&slopes, datasets, n, settings, curve, optimum, evaluations, &complete);
    if (status == WB_OK && complete) {
        status = leave_each_out(deviation, datasets, n, settings, &slopes, optimum, evaluations);
        if (status == WB_ERR_DATA) {
            wb_warn("wire '%s': no uncertainties, because a sample left out makes the rest "
                    "unusable",
                    datasets[0]->info.wire);
            status = WB_OK;
        }
    }
    free(memory);
    return status;
}
