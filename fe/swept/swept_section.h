/* Sections of swept bodies: a plane mesh of quadrilaterals, and its integrals.
 *
 * Coordinates of a section are y and z. Corners of a quadrilateral are counter-clockwise from y to
 * z. Shape functions N_a of its bilinear map are 1 at corner a. Integrals use 2 x 2 Gauss points,
 * which are exact for all integrals here except the second moment.
 */
#ifndef WB_FE_SWEPT_SWEPT_SECTION_H
#define WB_FE_SWEPT_SWEPT_SECTION_H

#include "base/memory.h"
#include "base/status.h"

struct wb_swept_section {
    int n_nodes;
    double (*node)[2]; /* (n_nodes): y, z, m */
    int n_quads;
    int (*quad)[4]; /* (n_quads): nodes at the corners */
    int centre;     /* an inner node, the origin of relative positions; on a circle's axis */
    int n_outline;  /* 0 unless created by wb_swept_section_init_circle() */
    int *outline;   /* (n_outline): nodes, counter-clockwise, from the +y axis of a circle */
    double *share;  /* (n_nodes): share of the area, by the integrals of N_a; their sum is 1 */
    double area;    /* m2 */
    struct wb_memory memory; /* of all arrays */
};

/* Integrals over a quadrilateral, for its elements' matrices. */
struct wb_swept_quad {
    double corner[4][2];    /* y, z, m */
    double area;            /* m2 */
    double mean[4];         /* mean of N_a over the area */
    double gradient[2][4];  /* means of dN_a/dy and dN_a/dz, 1/m */
    double weight[4];       /* of the points, divided by the area */
    double value[4][4];     /* N_a at point q: [q][a] */
    double at[4][2];        /* y, z of the points, m */
    double hourglass[4];    /* gamma_a: zero for linear fields, 1 for the field xi eta */
    double hourglass_slope; /* integral of |grad(xi eta)|^2, 1 */
};

/* The circle as an O-grid: a core of `core` x `core` quadrilaterals (even, 2 to 32) within `rings`
 * (0 to 32) rings of 4 `core` each; core^2 + 4 core rings in total, so 4 are (2, 0), 12 (2, 1), 32
 * (4, 1), 60 (6, 1), 84 (6, 2). The outline's nodes lie on the circle, at equal angles. */
WB_MUST_CHECK enum wb_status wb_swept_section_init_circle(struct wb_swept_section *section,
                                                          double diameter, int core, int rings);

void wb_swept_section_release(struct wb_swept_section *section); /* accepts a zeroed one */

/* Multiplies the positions of all nodes by `factor`. */
void wb_swept_section_scale(struct wb_swept_section *section, double factor);

void wb_swept_section_quad(const struct wb_swept_section *section, int quad,
                           struct wb_swept_quad *out);

#endif
