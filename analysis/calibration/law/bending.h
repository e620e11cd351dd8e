/* Bending properties of a wire's section from its law. */
#ifndef WB_ANALYSIS_CALIBRATION_LAW_BENDING_H
#define WB_ANALYSIS_CALIBRATION_LAW_BENDING_H

#include "base/status.h"
#include "fe/material/law.h"

/* Plastic strain in the middle of those of a test. In fits, the hardening stress at this strain is
 * a parameter in place of K, which is strongly correlated with n. */
#define WB_BENDING_PLASTIC_STRAIN 3e-3

/* Ludwik's law with isotropic hardening, of that hardening stress (Pa). */
struct wb_material wb_bending_material(double youngs_modulus, double poissons_ratio,
                                       double yield_stress, double hardening_stress,
                                       double exponent);

struct wb_bending {
    double flexural_rigidity;        /* EI of the virgin section, N m2 */
    double residual_curvature_ratio; /* residual over largest curvature, after bending to the
                                        largest curvature and unloading, 1 */
    double loop_energy; /* J/m lost per cycle: from the largest curvature to straight and back */
};

/* Properties up to the curvature `largest` (1/m, above 0), and moments (N m) of a first loading at
 * n curvatures (1/m, at least 0), of a solid circle. A law with Maxwell elements is loaded and
 * unloaded at its strain rate; the virgin section's EI includes them. Fails only for an invalid
 * law. */
WB_MUST_CHECK enum wb_status wb_bending_describe(const struct wb_law *law, double diameter,
                                                 double largest, struct wb_bending *bending);
WB_MUST_CHECK enum wb_status wb_bending_moments(const struct wb_law *law, double diameter, int n,
                                                const double *curvature, double *moment);

/* Secant stiffness of the section, N m2: `secant` of a first loading from straight to n curvatures,
 * and `unloading` over m changes of curvature on unloading from `largest` (1/m, above 0; changes
 * are at most `largest`). */
WB_MUST_CHECK enum wb_status wb_bending_stiffness(const struct wb_law *law, double diameter,
                                                  double largest, int n, const double *curvature,
                                                  double *secant, int m, const double *change,
                                                  double *unloading);

/* Springback of the deflection, 1 - d_0 / d_max, 1: of a cantilever of a free length (m, above 0)
 * with a vertical force at its end and without weight, bent until its clamp has the curvature
 * `largest` (1/m, above 0) and then unloaded. At large deflections, from M = F (x_tip - x) and the
 * curvatures of the section at each moment, loaded and unloaded, by quadrature. */
WB_MUST_CHECK enum wb_status wb_bending_springback(const struct wb_law *law, double diameter,
                                                   double length, double largest,
                                                   double *springback);

/* The law of Ludwik's form with isotropic hardening that bends like `law` on a first loading: E,
 * sigma_Y, K and n by least squares on ln M at curvatures up to `largest`. Its yield strain is at
 * least a thousandth of the largest strain; the misfit shows the error for a law that yields from
 * the start. Its unloading differs from that of `law`. *misfit is the root mean square of the
 * relative differences of M. */
WB_MUST_CHECK enum wb_status wb_bending_ludwik(const struct wb_law *law, double diameter,
                                               double largest, struct wb_material *equivalent,
                                               double *misfit);

/* Deviation of Ludwik's law with isotropic hardening of `material` from `law` on a first loading:
 * the largest relative difference of M between 1 % and 100 % of the largest curvature. */
WB_MUST_CHECK enum wb_status wb_bending_compare(const struct wb_law *law,
                                                const struct wb_material *material, double diameter,
                                                double largest, double *difference);

#endif
