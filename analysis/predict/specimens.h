/* Draws the mean law of N further wires of a product from the laws of n specimens.
 *
 * A law is four numbers q: ln E, ln sigma_Y, and the logarithms of the stress at plastic strains of
 * 1e-3 and 1e-2, of a specimen's Ludwik equivalent. K and n are strongly correlated and scatter
 * widely; stresses do not. With the mean m and the n x 4 deviations D of the specimens,
 *
 *   q = m + D' z sqrt((1/n + 1/N) / c),
 *
 * z of n independent normal numbers and c of chi-squared with n - 1 degrees of freedom. So q - m is
 * multivariate t with the specimens' covariance: the predictive distribution of the mean of N wires
 * of a normal population of which n specimens are known (Geisser, Predictive Inference, 1993). The
 * correlations between the four numbers are those of the specimens, also if n is below five.
 *
 * All N wires of one type in a bundle share one draw, of their mean, because the bundle's force is
 * nearly linear in the law of each wire.
 */
#ifndef WB_ANALYSIS_PREDICT_SPECIMENS_H
#define WB_ANALYSIS_PREDICT_SPECIMENS_H

#include <stdbool.h>

#include "analysis/calibration/properties/properties.h"
#include "fe/material/law.h"
#include "fe/material/material.h"

enum {
    WB_SPECIMENS_QUANTITIES = 4,
    WB_SPECIMENS_LEAST =
        3, /* with two, one in ten draws is farther away than six times their difference */
    WB_SPECIMENS_MOST = 100
};

struct wb_specimens {
    int n;
    double mean[WB_SPECIMENS_QUANTITIES];
    double deviation[WB_SPECIMENS_MOST][WB_SPECIMENS_QUANTITIES];
};

/* Initialises from the specimens of a calibration. False, without a change, if there are fewer than
 * WB_SPECIMENS_LEAST. */
bool wb_specimens_take(struct wb_specimens *specimens, const struct wb_properties *properties);

/* Numbers needed for a draw: n + 1. */
int wb_specimens_dimensions(const struct wb_specimens *specimens);

/* Makes a draw for `wires` (N, at least 1) wires from numbers u between 0 and 1 (exclusive). */
void wb_specimens_draw(const struct wb_specimens *specimens, int wires, const double *u,
                       double q[WB_SPECIMENS_QUANTITIES]);

/* q of a law; and E, sigma_Y, K and n of a law with q, whose other members stay. False if no such
 * law has these stresses: then the nearest n between 0.001 and `most_exponent` is used. */
void wb_specimens_quantities(const struct wb_material *law, double q[WB_SPECIMENS_QUANTITIES]);
bool wb_specimens_law(const double q[WB_SPECIMENS_QUANTITIES], double most_exponent,
                      struct wb_material *law);

/* Largest n of Ludwik's law with a hardening rule (struct wb_law): 2 as in properties files; 1 with
 * a kinematic share. */
double wb_specimens_most_exponent(double isotropic_share, bool is_combined);

/* Changes a law, of any form and rule, as the draw q differs from the specimens' mean: its first
 * loading is multiplied, at each strain, by the ratio of the stresses of the two Ludwik laws; of
 * Chaboche's form E, sigma_Y and the sum of the hardening at a strain of 1e-2. Form, rule and yield
 * strains of parallel parts stay, and with q the mean the law does. False as wb_specimens_law(). */
bool wb_specimens_shift(const struct wb_specimens *specimens,
                        const double q[WB_SPECIMENS_QUANTITIES], struct wb_law *law);

#endif
