/* The formulas of first_guess.c, for the initial guess of other fits and for tests. */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_FIRST_GUESS_PRIVATE_H
#define WB_ANALYSIS_CALIBRATION_PAPER_FIRST_GUESS_PRIVATE_H

#include "analysis/calibration/paper/first_guess.h"

/* Eq. 10: E = F L^3 / (3 delta I), Pa. */
double wb_first_guess_modulus(double force, double deflection, double length, double diameter);

/* Eq. 11: sigma = 32 F L / (pi d^3), the outer fibre's elastic stress at the clamp, Pa. */
double wb_first_guess_stress(double force, double length, double diameter);

/* Outer fibre's elastic strain at the clamp, eps = 3 d delta / (2 L^2). */
double wb_first_guess_strain(double deflection, double length, double diameter);

/* Eq. 16: K = E^n / sigma_Y^(n-1), Pa. */
double wb_first_guess_strength(double modulus, double yield_stress, double exponent);

#endif
