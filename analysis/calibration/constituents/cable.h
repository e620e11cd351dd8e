/* A layered cable between two bounds: wires in a ring around a core, which slide without friction,
 * or are bonded so that the cable's section stays plane.
 *
 * Three-point tests with other spans and deflections are compared at equal curvature. Curvature and
 * moment of a test are those of a slender elastic beam at midspan, 12 d / L^2 and F L / 4: the
 * nominal ones. Sliding wires have equal curvature and their moments add up,
 *
 *   M_free = n M_wire + M_core,
 *
 * which in forces is F(d) = (L1 / L) (n F1 + Fc) at deflections d L1^2 / L^2 of wire and core,
 * whose span is L1. Bonded wires add the axial forces of their conductors, each with the strain at
 * its centre: M_bonded = M_free + M_axial. The position of a measurement between the bounds is chi
 * = (M - M_free) / (M_bonded - M_free), 0 without friction and 1 when bonded.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CONSTITUENTS_CABLE_H
#define WB_ANALYSIS_CALIBRATION_CONSTITUENTS_CABLE_H

#include "base/reason.h"
#include "base/status.h"
#include "fe/material/material.h"

struct wb_cable_ring {
    int n_wires;
    double radius;                /* m, of the circle on which the wires' centres are */
    double area;                  /* m2, of one conductor's metal */
    struct wb_material conductor; /* isotropic hardening, or elastic */
};

/* Nominal curvature 12 d / L^2, 1/m; the deflection of a curvature, m; nominal moment F L / 4, N
 * m. */
double wb_cable_curvature(double deflection, double span);
double wb_cable_deflection(double curvature, double span);
double wb_cable_moment(double force, double span);

/* M_axial, N m, of bonded wires on a first loading at n nominal curvatures >= 0 (1/m), averaged
 * over the ring's orientation, which varies along the lay. Where conductors yield, curvature
 * concentrates at midspan: the moment over the curvature there is converted to the nominal
 * curvature by the deflection d = 2 int kappa(M x) x dx. WB_ERR_ARGUMENT for a ring without wires,
 * radius or area, and for kinematic hardening; `why` receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_cable_axial_moments(const struct wb_cable_ring *ring,
                                                    const double *curvature, int n, double *moment,
                                                    struct wb_reason *why);

/* A mean with its variance and degrees of freedom; NaN and 0 if a single value does not show the
 * scatter. */
struct wb_cable_mean {
    int n, n_series;
    double mean, variance, degrees;
};

/* The mean over tests, or, if they belong to more than one series, over the means of the series:
 * what the tests of a series have in common does not average out. `series` (n) contains an
 * arbitrary number for each series; values that are not finite are left out. */
struct wb_cable_mean wb_cable_mean(const double *values, const int *series, int n);

struct wb_cable_interval {
    double value, low, high; /* 95 %; low and high NaN: unknown */
};

/* A cable at one curvature, relative to the bounds. */
struct wb_cable_place {
    double measured, free, bonded;       /* N m */
    struct wb_cable_interval ratio, chi; /* measured over free; 1 */
};

/* Finds the position of a cable from the means of its tests, of a wire's, and of the core's.
 * Intervals are Student's with the degrees of freedom of Welch and Satterthwaite; that of the ratio
 * is of its logarithm. They include the scatter of tests and series, but not the uncertainty of the
 * conductor's law and area. */
void wb_cable_place(struct wb_cable_place *place, const struct wb_cable_mean *cable,
                    const struct wb_cable_mean *wire, const struct wb_cable_mean *core, int n_wires,
                    double axial);

#endif
