/* The homogenised wire of a comparison, computed with the 1D beam under a growing follower force.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_ROD_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_ROD_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material/material.h"

enum {
    WB_WIRES_POINTS = 101, /* along the wire */
    WB_WIRES_STEPS = 96    /* of the force */
};

struct wb_wires_wire {
    double length, diameter; /* m */
    struct wb_material material;
    double force;             /* N, of the follower at the end */
    int n_elements, n_fibres; /* 0: the beam's own */
};

struct wb_wires_rod {
    bool done;    /* there is a last state */
    bool reached; /* the whole force; else it stopped before */
    int n_curve;  /* states reached, the first without force */
    double force[WB_WIRES_STEPS + 1], deflection[WB_WIRES_STEPS + 1];  /* N, m */
    double angle[WB_WIRES_STEPS + 1];                                  /* rad, tip */
    double tip_angle;                                                  /* rad, of the last state: */
    double s[WB_WIRES_POINTS], x[WB_WIRES_POINTS], y[WB_WIRES_POINTS]; /* m */
    double curvature[WB_WIRES_POINTS]; /* 1/m, of the exact solution only */
};

WB_MUST_CHECK enum wb_status wb_wires_rod_compute(struct wb_wires_rod *rod,
                                                  const struct wb_wires_wire *wire);

/* The exact solution for a linear elastic wire that neither stretches nor shears: only the last
 * state, by integration of the elastica from the tip, where angle and curvature are known. */
void wb_wires_rod_exact(struct wb_wires_rod *rod, const struct wb_wires_wire *wire);

/* Curvature at an arc length, m; NaN outside. */
double wb_wires_rod_curvature(const struct wb_wires_rod *rod, double s);

#endif
