/* What a law says of a wire's section under pure bending: the numbers that users take away. */
#ifndef WB_ANALYSIS_CALIBRATION_LAW_BENDING_H
#define WB_ANALYSIS_CALIBRATION_LAW_BENDING_H

#include "base/status.h"
#include "fe/material/law.h"

struct wb_bending {
    double flexural_rigidity;        /* EI of the virgin section, N m2 */
    double residual_curvature_ratio; /* residual over largest curvature: bent to the largest and let
                                        go, 1 */
    double loop_energy; /* J/m lost each time: from the largest curvature straight and back */
};

/* Of a solid circle. A law with Maxwell elements is bent and unloaded at its strain rate; the
 * virgin section's EI includes them. Up to `largest` (1/m, above 0). Moments (N m) of a first
 * loading at n curvatures (1/m, at least 0). Fails only for an invalid law. */
WB_MUST_CHECK enum wb_status wb_bending_describe(const struct wb_law *law, double diameter,
                                                 double largest, struct wb_bending *bending);
WB_MUST_CHECK enum wb_status wb_bending_moments(const struct wb_law *law, double diameter, int n,
                                                const double *curvature, double *moment);

/* Stiffness of the section between two places of its moment, N m2: `secant` of a first loading from
 * straight to n curvatures, and `unloading` over m changes of the curvature during unloading from
 * `largest` (1/m, above 0, at most `largest`). */
WB_MUST_CHECK enum wb_status wb_bending_stiffness(const struct wb_law *law, double diameter,
                                                  double largest, int n, const double *curvature,
                                                  double *secant, int m, const double *change,
                                                  double *unloading);

/* Ludwik's law with isotropic hardening that bends like `law` on a first loading: E, sigma_Y, K and
 * n by least squares on ln M at curvatures up to `largest`. It yields at a thousandth of the
 * largest strain or above: for a law that yields from the start the misfit tells how far that is
 * off. What it says of the unloading is another rule's. *misfit is the root mean square of the
 * relative differences of M. */
WB_MUST_CHECK enum wb_status wb_bending_ludwik(const struct wb_law *law, double diameter,
                                               double largest, struct wb_material *equivalent,
                                               double *misfit);

/* How far Ludwik's law with isotropic hardening of `material` is from `law` on a first loading:
 * the largest relative difference of M from 1 % of the largest curvature on. */
WB_MUST_CHECK enum wb_status wb_bending_compare(const struct wb_law *law,
                                                const struct wb_material *material, double diameter,
                                                double largest, double *difference);

#endif
