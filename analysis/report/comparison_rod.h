/* The homogenised wire of a comparison, computed with the 1D beam under a growing follower force.
 */
#ifndef WB_ANALYSIS_REPORT_COMPARISON_ROD_H
#define WB_ANALYSIS_REPORT_COMPARISON_ROD_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material/material.h"

enum {
    WB_COMPARISON_POINTS = 101, /* along the wire */
    WB_COMPARISON_STEPS = 96    /* of the force */
};

struct wb_comparison_wire {
    double length, diameter; /* m */
    struct wb_material material;
    double force;             /* N, of the follower at the end */
    int n_elements, n_fibres; /* 0: the beam's own */
};

struct wb_comparison_rod {
    bool done;    /* there is a last state */
    bool reached; /* the whole force; else it stopped before */
    int n_curve;  /* states reached, the first without force */
    double force[WB_COMPARISON_STEPS + 1], deflection[WB_COMPARISON_STEPS + 1]; /* N, m */
    double angle[WB_COMPARISON_STEPS + 1];                                      /* rad, tip */
    double tip_angle; /* rad, of the last state: */
    double s[WB_COMPARISON_POINTS], x[WB_COMPARISON_POINTS], y[WB_COMPARISON_POINTS]; /* m */
    double curvature[WB_COMPARISON_POINTS]; /* 1/m, of the exact solution only */
};

WB_MUST_CHECK enum wb_status wb_comparison_rod_compute(struct wb_comparison_rod *rod,
                                                       const struct wb_comparison_wire *wire);

/* The exact solution for a linear elastic wire that neither stretches nor shears: only the last
 * state, by integration of the elastica from the tip, where angle and curvature are known. */
void wb_comparison_rod_exact(struct wb_comparison_rod *rod, const struct wb_comparison_wire *wire);

/* Curvature at an arc length, m; NaN outside. */
double wb_comparison_rod_curvature(const struct wb_comparison_rod *rod, double s);

#endif
