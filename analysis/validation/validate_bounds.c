#include "analysis/validation/validate_bounds.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

#include "base/units.h"

/* Level of each part's bound, so that a correct law exceeds any bound in one of twenty validations:
 * tests/analysis/validation. */
static const double level = 0.028;
/* Smallest standard deviations between samples that are used: of the unloading over F_max, of the
 * residual deflection in m. The deviation of few samples is often too small by chance. */
static const double least_unloading = 2e-3, least_residual = 0.2 * WB_MM;
/* Error of the law that is allowed, in units of its misfit in the calibration. */
static const double misfits = 2.0;

static const struct part {
    const char *name, *key;
    double unit;
} parts[WB_VALIDATE_PARTS] = {
    [WB_VALIDATE_LOADING] = {"loading", "loading", 1.0},
    [WB_VALIDATE_UNLOADING] = {"unloading", "unloading", 1.0},
    [WB_VALIDATE_RESIDUAL] = {"residual deflection", "residual_deflection_mm", WB_MM},
    [WB_VALIDATE_SHAPES] = {"shapes", "shapes_mm", WB_MM},
};

const char *wb_validate_part_name(enum wb_validate_part part)
{
    return parts[part].name;
}

const char *wb_validate_part_key(enum wb_validate_part part)
{
    return parts[part].key;
}

double wb_validate_part_unit(enum wb_validate_part part)
{
    return parts[part].unit;
}

static double students(int degrees)
{
    return degrees > 0 ? gsl_cdf_tdist_Qinv(0.5 * level, degrees) : (double)NAN;
}

static void set(struct wb_validate_result *result, enum wb_validate_part part, double found,
                double bound)
{
    result->bounds[part] = (struct wb_validate_bound){found, bound, found > bound};
}

void wb_validate_bounds_find(struct wb_validate_result *result,
                             const struct wb_properties *properties)
{
    const struct wb_validate_cycles *const cycles = &result->cycles;
    const int m = wb_properties_units(properties);
    const double of_calibration = m > 0 ? 1.0 / m : 0.0;
    const double misfit = isfinite(properties->rms) ? misfits * properties->rms : 0.0;
    const double none = (double)NAN;

    set(result, WB_VALIDATE_LOADING, result->elastoplastic.rms,
        hypot(students(result->stiffness_degrees) * result->expected_rms, misfit));

    const int n = cycles->n_adapted;
    set(result, WB_VALIDATE_UNLOADING, n > 0 ? cycles->adapted_rms : none,
        n > 1 ? hypot(students(n - 1) * fmax(cycles->adapted_scatter, least_unloading) *
                          sqrt(1.0 / n + of_calibration),
                      misfit)
              : none);
    const int r = cycles->n_residuals;
    set(result, WB_VALIDATE_RESIDUAL, r > 1 ? fabs(cycles->adapted_residual) : none,
        r > 1 ? students(r - 1) * fmax(cycles->residual_scatter, least_residual) *
                    sqrt(1.0 / r + of_calibration)
              : none);
    const struct wb_marker_mean *const s = &result->shapes;
    const double k = s->n_positions, degrees = k * (s->n_samples - 1);
    set(result, WB_VALIDATE_SHAPES, s->rms,
        degrees > 0.0 ? s->scatter * sqrt(gsl_cdf_fdist_Qinv(level, k, degrees) / s->n_samples)
                      : none);
}

void wb_validate_bounds_append(struct wb_text *text, const struct wb_validate_result *result)
{
    const char *between = "";
    for (int i = 0; i < WB_VALIDATE_PARTS; i++) {
        if (!result->bounds[i].is_exceeded)
            continue;
        wb_text_append(text, "%s%s", between, parts[i].name);
        between = ", ";
    }
}

bool wb_validate_bounds_exceeded(const struct wb_validate_result *result)
{
    for (int i = 0; i < WB_VALIDATE_PARTS; i++) {
        if (result->bounds[i].is_exceeded)
            return true;
    }
    return false;
}

bool wb_validate_bounds_known(const struct wb_validate_result *result)
{
    for (int i = 0; i < WB_VALIDATE_PARTS; i++) {
        if (isfinite(result->bounds[i].bound))
            return true;
    }
    return false;
}

enum wb_validate_verdict wb_validate_bounds_verdict(const struct wb_validate_result *result)
{
    if (result->elastoplastic.n_reached < result->elastoplastic.n)
        return WB_VALIDATE_NOT_CONVERGED;
    if (wb_validate_bounds_exceeded(result))
        return WB_VALIDATE_NOT_PREDICTED;
    if (result->is_beyond)
        return WB_VALIDATE_BEYOND;
    return isfinite(result->bounds[WB_VALIDATE_LOADING].bound) ? WB_VALIDATE_PREDICTED
                                                               : WB_VALIDATE_UNDECIDED;
}
