/* The geometrically exact rod in space (Reissner 1981; Simo 1985, CMAME 49:55; Simo & Vu-Quoc 1986,
 * CMAME 58:79), in elements whose unknown strains determine everything.
 *
 * A section at arc length s has position r and rotation R (columns: its x along the rod, y, z). Its
 * material strains and their forces are
 *
 *     G = R^T r' - (1, 0, 0),  N;     k = axial vector of R^T R' (twist, ky, kz),  M.
 *
 * Within an element k is linear, given by its values at the two Gauss points, and the rotation
 * relative to the first node is exp(p(s)) with Magnus' series to fourth order, for k = a + b s
 *
 *     p(s) = a s + b s^2 / 2 + a x b s^3 / 12,
 *
 * exact in a plane and for a constant k (helix). Then r' = R (G + (1, 0, 0)) at the Gauss points,
 * and r' is linear between them. Rotations follow from strains, never strains from rotations, so a
 * rigid rotation changes no strain and the strains do not depend on the path: the requirements of
 * Crisfield & Jelenic (1999, Proc. R. Soc. A 455:1125) for an interpolation (cf. Zupan & Saje 2003,
 * CMAME 192:5209). In a plane the element reduces to that of fe/rod/beam_element.h.
 *
 * Equilibrium is that of virtual motions dr, dt (t: spin) that are quadratic in space: sum w (n .
 * (dr' - dt x r') + m . dt') with n = R N, m = R M. Rigid motions are among them, so forces and
 * moments balance exactly. The tangent also takes the variations of the strains from quadratic
 * motions. In space these differ from the exact variations by a small amount (fourth power of the
 * element's rotation between its nodes), so Newton's method converges slightly slower than
 * quadratically, to the same result.
 *
 * Unknowns of a node: increments of r and of the spin, in space.
 */
#ifndef WB_FE_ROD_ROD_ELEMENT_H
#define WB_FE_ROD_ROD_ELEMENT_H

#include "fe/rod/rod_section.h"
#include "fe/rod/rod_shape.h"

enum {
    WB_ROD_ELEMENT_NODES = WB_ROD_SHAPE_NODES,
    WB_ROD_ELEMENT_POINTS = WB_ROD_SHAPE_POINTS,
    WB_ROD_ELEMENT_UNKNOWNS = 6 /* of a node */
};

struct wb_rod_node {
    double position[3];
    double rotation[4]; /* unit quaternion, scalar first */
};

/* Strains of a Gauss point: stretch (axial, shears along y, z) and curvature (twist, ky, kz). */
struct wb_rod_strain {
    double stretch[3], curvature[3];
};

/* One Gauss point. */
struct wb_rod_point {
    double R[9];       /* row-major */
    double slope[3];   /* r' */
    double n[3], m[3]; /* N, N m, in space */
    double shear_stiffness;
    struct wb_rod_section_response section;
};

/* Blocks of an element's stiffness, row-major 6 x 6, K[i][j]. */
struct wb_rod_element_stiffness {
    double K[WB_ROD_ELEMENT_NODES][WB_ROD_ELEMENT_NODES]
            [WB_ROD_ELEMENT_UNKNOWNS * WB_ROD_ELEMENT_UNKNOWNS];
};

/* Places nodes 1 and 2 of an element from its node 0 and the total stretches (including the 1) and
 * curvatures of its points; sets the points' rotation R and slope. */
void wb_rod_element_place(const struct wb_rod_shape *shape, const struct wb_rod_strain *total,
                          struct wb_rod_node *nodes, struct wb_rod_point *points);

/* Rotation at arc length s within an element whose first node has rotation `first`. */
void wb_rod_element_rotation(const struct wb_rod_shape *shape, const struct wb_rod_strain *total,
                             double s, const double first[4], double rotation[4]);

/* Rotates the forces of a point's section and its shear strains (y, z) into space. */
void wb_rod_element_turn_forces(struct wb_rod_point *point, const double *shear);

/* Adds the internal forces of Gauss point g to f (3 nodes x 6). */
void wb_rod_element_add_forces(const struct wb_rod_shape *shape, int g,
                               const struct wb_rod_point *point, double *restrict f);

/* Computes the element's tangent stiffness from its two points. */
void wb_rod_element_stiffness(const struct wb_rod_shape *shape, const struct wb_rod_point *points,
                              struct wb_rod_element_stiffness *restrict stiffness);

/* Increment of the strains of point g for nodal increments d (3 nodes x 6). */
void wb_rod_element_strain_increment(const struct wb_rod_shape *shape, int g,
                                     const struct wb_rod_point *point, const double *d,
                                     struct wb_rod_strain *increment);

/* Size of a force and a moment: the largest component, moments times `lever` (1/m); NaN if one is.
 */
double wb_rod_element_force_size(const double force[6], double lever);

/* Rotation matrix (row-major) of a unit quaternion. */
void wb_rod_element_matrix(const double q[4], double R[9]);

/* Product c = a b of unit quaternions, the quaternion of a rotation vector, and the rotation vector
 * in space that turns `from` to `to`, at most pi long. */
void wb_rod_element_compose(const double a[4], const double b[4], double c[4]);
void wb_rod_element_exponential(const double vector[3], double q[4]);
void wb_rod_element_turn_between(const double from[4], const double to[4], double vector[3]);

/* The shortest rotation vector in space that turns the x axis of a rotation to a direction (a unit
 * vector); where they are opposite, about the rotation's own y axis. */
void wb_rod_element_turn_axis(const double from[4], const double direction[3], double vector[3]);

#endif
