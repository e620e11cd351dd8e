/* A layered cable between two bounds: wires laid in a ring round a core, which slide without
 * friction, or are bonded so that the cable's section stays plane.
 *
 * Three-point tests at other spans and deflections are compared at equal curvature. What a test
 * shows is taken as that of a slender elastic beam, curvature 12 d / L^2 and moment F L / 4 in the
 * middle: the nominal ones. Wires that slide bend alike and their moments add,
 *
 *     M_free = n M_wire + M_core,
 *
 * which in forces is F(d) = (L1 / L) (n F1 + Fc) at deflections d L1^2 / L^2 of wire and core,
 * whose span is L1. Wires that are bonded add what their conductors bear along their axes, each
 * with the strain that its centre has: M_bonded = M_free + M_axial. The place of a measurement
 * between them is chi = (M - M_free) / (M_bonded - M_free), 0 without friction and 1 when bonded.
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
    struct wb_material conductor; /* its surface grows, or it is elastic */
};

/* 12 d / L^2, 1/m; and the deflection of a curvature. F L / 4, N m. */
double wb_cable_curvature(double deflection, double span);
double wb_cable_deflection(double curvature, double span);
double wb_cable_moment(double force, double span);

/* M_axial, N m, at n nominal curvatures >= 0 (1/m): of bonded wires on a first loading, averaged
 * over the ring's orientation, which a lay runs through. Where conductors yield, curvature gathers
 * in the middle: the moment over the curvature there is brought to the nominal one by the
 * deflection d = 2 int kappa(M x) x dx. WB_ERR_ARGUMENT for a ring without wires, radius or area,
 * and for a law whose surface moves; the reason goes to `why` (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_cable_axial_moments(const struct wb_cable_ring *ring,
                                                    const double *curvature, int n, double *moment,
                                                    struct wb_reason *why);

/* A mean with the variance of itself and its degrees of freedom; NaN and 0 where one value tells
 * nothing of the scatter. */
struct wb_cable_mean {
    int n, n_series;
    double mean, variance, degrees;
};

/* The mean over tests, or, where they are of more than one series, over the means of the series:
 * what a series has in common does not average out over its tests. `series` (n) holds any number a
 * series; values that are not finite are left out. */
struct wb_cable_mean wb_cable_mean(const double *values, const int *series, int n);

struct wb_cable_interval {
    double value, low, high; /* 95 %; low and high NaN: not known */
};

/* A cable at one curvature. */
struct wb_cable_place {
    double measured, free, bonded;       /* N m */
    struct wb_cable_interval ratio, chi; /* measured over free; 1 */
};

/* Places a cable by the means of its tests, of a wire's, and of the core's. Intervals are Student's
 * with the degrees of freedom of Welch and Satterthwaite; that of the ratio is of its logarithm.
 * They hold the scatter of tests and series, not what the conductor's law and area leave open. */
void wb_cable_place(struct wb_cable_place *place, const struct wb_cable_mean *cable,
                    const struct wb_cable_mean *wire, const struct wb_cable_mean *core, int n_wires,
                    double axial);

#endif
