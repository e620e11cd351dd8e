#include "analysis/calibration/paper/first_guess.h"

#include <math.h>

#include "base/circle.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "first guess"

/* Range of deflection over length, on either side of a point, in which its force is fitted: wide
 * enough to reduce noise, narrow enough for the curvature at yield (0.5 % of the force). */
#define FORCE_RANGE 0.0125
/* Range of deflection over length for the slope beyond yield: the paper's 'small range'. A shorter
 * range is dominated by the cell's noise, a longer one by the curvature. */
#define SLOPE_RANGE 0.03
#define FEWEST_SLOPE_POINTS 3
/* Step of deflection over length of a follower test's curve after its conversion. */
#define TURNED_STEP 0.005
/* Limits of n0. */
#define SMALLEST_EXPONENT 0.05
#define LARGEST_EXPONENT 1.2

double wb_first_guess_modulus(double force, double deflection, double length, double diameter)
{
    const double second_moment = wb_circle_second_moment(diameter);
    return force * pow(length, 3) / (3.0 * deflection * second_moment);
}

double wb_first_guess_stress(double force, double length, double diameter)
{
    return 32.0 * force * length / (M_PI * pow(diameter, 3));
}

double wb_first_guess_strain(double deflection, double length, double diameter)
{
    return 3.0 * diameter * deflection / (2.0 * length * length);
}

double wb_first_guess_strength(double modulus, double yield_stress, double exponent)
{
    /* Written so that E^n / sigma_Y^(n-1) does not overflow. */
    return yield_stress * pow(modulus / yield_stress, exponent);
}

/* Line through grid points first..last: its value at `deflection`, and its slope. */
static double fit_line(const struct wb_curve *curve, int first, int last, double deflection,
                       double *slope)
{
    const int n = last - first + 1;
    const double middle = 0.5 * (first + last) * curve->step;
    double mean = 0.0, xx = 0.0, xy = 0.0;
    for (int i = first; i <= last; i++) {
        const double x = i * curve->step - middle;
        mean += curve->force[i] / n;
        xx += x * x;
        xy += x * curve->force[i];
    }
    *slope = xy / xx;
    return mean + *slope * (deflection - middle);
}

/* Force at a deflection from a straight line fitted to the grid points around it, at least one on
 * either side. */
static double force_at(const struct wb_curve *curve, double deflection, double length)
{
    const double place = deflection / curve->step, half = FORCE_RANGE * length / curve->step;
    int first = (int)fmin(ceil(place - half), floor(place));
    int last = (int)fmax(floor(place + half), floor(place) + 1.0);
    double slope;
    if (last > curve->n - 1)
        last = curve->n - 1;
    if (first > last - 1)
        first = last - 1;
    if (first < 0)
        first = 0;
    return fit_line(curve, first, last, deflection, &slope);
}

static enum wb_status check_reach(const struct wb_curve *curve, const struct wb_test_info *info,
                                  double elastic_zone, double yield_point, struct wb_reason *why)
{
    const double needed = fmax(elastic_zone, yield_point + SLOPE_RANGE) * info->length;
    if (curve->max_deflection < needed)
        return wb_fail_to(
            why, WB_ERR_DATA,
            "wire '%s': yield is not reached: the first loading ends at %.2f mm, expected at least "
            "%.2f mm (the yield point at %g of the length, and %g more for the slope beyond it)",
            info->wire, curve->max_deflection / WB_MM, needed / WB_MM, yield_point, SLOPE_RANGE);
    if (fmin(elastic_zone, yield_point) * info->length < 2.0 * curve->step)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s': too few points below the yield point: %.2f mm with steps of "
                          "%g mm; use a smaller step",
                          info->wire, fmin(elastic_zone, yield_point) * info->length / WB_MM,
                          curve->step / WB_MM);
    return WB_OK;
}

/* Checks that the curve as a whole rises. */
static enum wb_status check_shape(const struct wb_curve *curve, const struct wb_test_info *info,
                                  struct wb_reason *why)
{
    double variation = 0.0, low = curve->force[0], high = curve->force[0];
    for (int i = 0; i < curve->n; i++) {
        if (!isfinite(curve->force[i]))
            return wb_fail_to(why, WB_ERR_DATA, "wire '%s': the force at %.2f mm is not a number",
                              info->wire, i * curve->step / WB_MM);
        low = fmin(low, curve->force[i]);
        high = fmax(high, curve->force[i]);
        if (i > 0)
            variation += fabs(curve->force[i] - curve->force[i - 1]);
    }
    const double start = curve->force[0];
    if (!(high > low) || variation > 3.0 * (high - low))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s': the force does not rise steadily with the deflection (its "
                          "changes add up to %.4g N, between %.4g and %.4g N)",
                          info->wire, variation, low, high);
    if (start - low > 0.5 * (high - low))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s': the force falls as the deflection grows (from %.4g to %.4g "
                          "N): check its sign",
                          info->wire, start, low);
    return WB_OK;
}

/* The first guess from a curve of force over deflection. */
static enum wb_status run(struct wb_first_guess *guess, const struct wb_curve *curve,
                          const struct wb_test_info *info, double elastic_zone, double yield_point,
                          struct wb_reason *why)
{
    const double length = info->length, diameter = info->outer_diameter;
    WB_TRY(check_reach(curve, info, elastic_zone, yield_point, why));
    WB_TRY(check_shape(curve, info, why));
    struct wb_first_guess result;
    const double elastic_deflection = elastic_zone * length;
    const double elastic_force = force_at(curve, elastic_deflection, length);
    const double yield_force = force_at(curve, yield_point * length, length);
    if (!(elastic_force > 0.0) || !(yield_force > 0.0))
        return wb_fail_to(
            why, WB_ERR_DATA,
            "wire '%s': the force in the elastic zone is not positive (%.4g N at %.2f "
            "mm)",
            info->wire, elastic_force, elastic_deflection / WB_MM);
    result.youngs_modulus =
        wb_first_guess_modulus(elastic_force, elastic_deflection, length, diameter);
    result.yield_stress = wb_first_guess_stress(yield_force, length, diameter);

    const int first = (int)ceil(yield_point * length / curve->step - 1e-9);
    int last = (int)floor((yield_point + SLOPE_RANGE) * length / curve->step + 1e-9);
    if (last < first + FEWEST_SLOPE_POINTS - 1)
        last = first + FEWEST_SLOPE_POINTS - 1;
    if (last > curve->n - 1)
        return wb_fail_to(why, WB_ERR_DATA, "wire '%s': too few points beyond the yield point",
                          info->wire);
    double slope;
    (void)fit_line(curve, first, last, first * curve->step, &slope);
    /* d sigma / d eps = (dF / d delta) (32 L / (pi d^3)) / (3 d / (2 L^2)). */
    result.tangent_modulus = wb_first_guess_stress(slope, length, diameter) /
                             wb_first_guess_strain(1.0, length, diameter);
    if (!(result.tangent_modulus > 0.0))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s': the force falls just past the yield point (slope %.4g N/m): "
                          "no hardening law fits",
                          info->wire, slope);
    result.hardening_exponent = fmin(
        fmax(result.tangent_modulus / result.youngs_modulus, SMALLEST_EXPONENT), LARGEST_EXPONENT);
    result.strength_coefficient = wb_first_guess_strength(
        result.youngs_modulus, result.yield_stress, result.hardening_exponent);
    *guess = result;
    return WB_OK;
}

enum wb_status wb_first_guess_run(struct wb_first_guess *guess, const struct wb_curve *curve,
                                  const struct wb_test_info *info, double elastic_zone,
                                  double yield_point, struct wb_reason *why)
{
    struct wb_curve turned;
    if (!curve->is_follower)
        return run(guess, curve, info, elastic_zone, yield_point, why);
    WB_TRY(wb_curve_turn(&turned, curve, TURNED_STEP * info->length, why));
    const enum wb_status status = run(guess, &turned, info, elastic_zone, yield_point, why);
    wb_curve_release(&turned);
    return status;
}
