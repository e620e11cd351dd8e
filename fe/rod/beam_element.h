/* The planar geometrically exact (Simo-Reissner) beam, quadratic three-node element.
 *
 * A section at arc length s has position (x, y) and rotation t. Its strains are
 *
 *     eps   =  x' cos t + y' sin t   less the same of the reference configuration,
 *     gamma = -x' sin t + y' cos t   less the same of the reference configuration,
 *     kappa =  t'                    less the natural curvature,
 *
 * and its resultants N, Q, M do work on them (Simo 1985, CMAME 49:55; Reissner 1972). Position and
 * rotation are interpolated with the same quadratics, x' = sum N_i' x_i; two Gauss points an
 * element (reduced integration) keep it from locking. Unknowns of a node: x, y, t.
 */
#ifndef WB_FE_ROD_BEAM_ELEMENT_H
#define WB_FE_ROD_BEAM_ELEMENT_H

enum {
    WB_BEAM_ELEMENT_NODES = 3,
    WB_BEAM_ELEMENT_POINTS = 2
};

/* x, y, t of one node. */
struct wb_beam_node {
    double x, y, t;
};

/* Shape functions and derivatives by arc length at the two Gauss points of an element of length h;
 * the same for all elements of a beam. */
struct wb_beam_element_shape {
    double weight;                                            /* m */
    double N[WB_BEAM_ELEMENT_POINTS][WB_BEAM_ELEMENT_NODES];  /* 1 */
    double dN[WB_BEAM_ELEMENT_POINTS][WB_BEAM_ELEMENT_NODES]; /* 1/m */
};

/* One Gauss point: what the reference subtracts, the present kinematics, and the resultants. */
struct wb_beam_point {
    double reference_a, reference_b, reference_k;
    double cosine, sine; /* of t */
    double a, b, k;      /* x' cos t + y' sin t, -x' sin t + y' cos t, t' */
    double N, Q, M;
    double D11, D12, D22, G; /* tangents: d(N, M)/d(eps, kappa), dQ/d(gamma) */
};

/* Symmetric blocks of an element's stiffness, row-major 3 x 3, K[i][j] for i <= j. */
struct wb_beam_element_stiffness {
    double K11[9], K12[9], K13[9], K22[9], K23[9], K33[9];
};

/* Fills in the shape functions of an element of length h, m. */
void wb_beam_element_shape_init(struct wb_beam_element_shape *shape, double h);

/* Rotation at Gauss point g: fills cosine, sine, k. */
void wb_beam_element_rotation(const struct wb_beam_element_shape *shape, int g,
                              const struct wb_beam_node *nodes, struct wb_beam_point *point);

/* All kinematics of Gauss point g, from positions: fills cosine, sine, a, b, k. */
void wb_beam_element_kinematics(const struct wb_beam_element_shape *shape, int g,
                                const struct wb_beam_node *nodes, struct wb_beam_point *point);

/* Adds the internal forces of Gauss point g to f (3 nodes x 3). */
void wb_beam_element_add_forces(const struct wb_beam_element_shape *shape, int g,
                                const struct wb_beam_point *point, double *restrict f);

/* The element's tangent stiffness from its two points. */
void wb_beam_element_stiffness(const struct wb_beam_element_shape *shape,
                               const struct wb_beam_point *points,
                               struct wb_beam_element_stiffness *restrict stiffness);

#endif
