/* Closed forms of section 4.1: E and sigma_Y from the elastic zone, and the first guess of K and n
 * for the optimiser (eqs. 10 to 16 of the paper).
 *
 * Eqs. 10 and 11 assume a straight, weightless cantilever under a vertical tip force and small
 * deflection; they are applied as printed to the zeroed force. Eqs. 12 to 16 are Hollomon's form
 * (sigma = K eps^n in the total strain) and serve only for the first guess: the calibrated law is
 * Ludwik's (plastic strain only).
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_FIRST_GUESS_H
#define WB_ANALYSIS_CALIBRATION_PAPER_FIRST_GUESS_H

#include "analysis/dataset/curve.h"
#include "base/reason.h"
#include "base/status.h"

struct wb_first_guess {
    double youngs_modulus;       /* eq. 10 at elastic_zone * L, Pa */
    double yield_stress;         /* eq. 11 at yield_point * L, Pa */
    double tangent_modulus;      /* slope of the sigma-eps curve just beyond yield, Pa */
    double strength_coefficient; /* K0, Pa */
    double hardening_exponent;   /* n0; kept within 0.05..1.2, where eq. 16 is meaningful */
};

/* Finds all values from an averaged curve of a wire with the length and diameter of `info`. A
 * follower test's curve is first converted to force over deflection: at small deflection a follower
 * force differs from a vertical one by the square of the slope. The force at a deflection is that
 * of a straight line fitted within 1.25 % of L around it; the slope beyond yield is fitted over the
 * 3 % of L after the yield point. WB_ERR_DATA for an unusable curve: too short to yield, reversed
 * sign, not rising, decreasing after the yield point. `why` receives the reason; NULL: it is
 * logged. */
WB_MUST_CHECK enum wb_status wb_first_guess_run(struct wb_first_guess *guess,
                                                const struct wb_curve *curve,
                                                const struct wb_test_info *info,
                                                double elastic_zone, double yield_point,
                                                struct wb_reason *why);

/* Eq. 10: E = F L^3 / (3 delta I), Pa. */
double wb_first_guess_modulus(double force, double deflection, double length, double diameter);

/* Eq. 11: sigma = 32 F L / (pi d^3), the outer fibre's elastic stress at the clamp, Pa. */
double wb_first_guess_stress(double force, double length, double diameter);

/* Outer fibre's elastic strain at the clamp, eps = 3 d delta / (2 L^2). */
double wb_first_guess_strain(double deflection, double length, double diameter);

/* Eq. 16: K = E^n / sigma_Y^(n-1), Pa. */
double wb_first_guess_strength(double modulus, double yield_stress, double exponent);

#endif
