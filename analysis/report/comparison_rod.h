/* The homogenised wire of a comparison, computed with the 1D beam under a growing follower force.
 */
#ifndef WB_ANALYSIS_REPORT_COMPARISON_ROD_H
#define WB_ANALYSIS_REPORT_COMPARISON_ROD_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material.h"

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
    bool done;    /* computed at all */
    bool reached; /* the whole force; else it stopped before */
    int n_curve;  /* states reached, the first without force */
    double force[WB_COMPARISON_STEPS + 1], deflection[WB_COMPARISON_STEPS + 1]; /* N, m */
    double angle[WB_COMPARISON_STEPS + 1];                                      /* rad, tip */
    /* Of the last state: axis and its curvature by the moment of the tip force over E I, which is
     * that of an elastic wire. */
    double s[WB_COMPARISON_POINTS], x[WB_COMPARISON_POINTS], y[WB_COMPARISON_POINTS]; /* m */
    double curvature[WB_COMPARISON_POINTS];                                           /* 1/m */
};

WB_MUST_CHECK enum wb_status wb_comparison_rod_compute(struct wb_comparison_rod *rod,
                                                       const struct wb_comparison_wire *wire);

/* Curvature at an arc length, m; NaN outside. */
double wb_comparison_rod_curvature(const struct wb_comparison_rod *rod, double s);

#endif
