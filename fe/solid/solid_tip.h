/* The free end of a swept wire: averages of its motion, and its loads.
 *
 * The nine numbers z = (x, g_y, g_z) are the E-weighted average of the end faces' positions and
 * their least-squares gradients with respect to the section's axes; an undeformed end has g_y =
 * e_y, g_z = e_z. Loads do work on z only: phi . dz, with
 *
 *     phi_x  = dead force + follower force rotated with the frame + tension along its direction,
 *     phi_g  = m x g,  (|g_y|^2 + |g_z|^2) m - g_y (g_y . m) - g_z (g_z . m) = moment,
 *
 * so that the couple of tractions has exactly the given moment about the average.
 */
#ifndef WB_FE_SOLID_SOLID_TIP_H
#define WB_FE_SOLID_SOLID_TIP_H

#include "fe/solid/solid_model.h"

enum {
    WB_SOLID_TIP_PATTERNS = 3,
    WB_SOLID_TIP_UNKNOWNS = 9
};

struct wb_solid_tip_section {
    int n_nodes;
    int *node;            /* (n_nodes), owned */
    double (*pattern)[3]; /* (n_nodes): weights of x, g_y, g_z at each node; owned */
    double radius;        /* radius of gyration, m: scales rotations to displacements */
};

/* Computes the averages from a swept mesh's end faces and each part's Young's modulus. */
void wb_solid_tip_init(struct wb_solid_tip_section *tip, const struct wb_solid_mesh *mesh,
                       const struct wb_solid_part *parts);
void wb_solid_tip_release(struct wb_solid_tip_section *tip); /* accepts a zeroed one */

/* z for displacements u (3 n_nodes). */
void wb_solid_tip_motion(const struct wb_solid_tip_section *tip, const struct wb_solid_mesh *mesh,
                         const double *u, double z[WB_SOLID_TIP_UNKNOWNS]);

/* The frame for z: rows along the wire, the section's y, its z. */
void wb_solid_tip_frame(const double z[WB_SOLID_TIP_UNKNOWNS], double frame[3][3]);

/* The strand that prescribes a deflection. */
struct wb_solid_tip_strand {
    double length; /* m; 0: a vertical force */
    double x;      /* x of the upper end, m */
};

/* phi, its derivative with respect to z (9 x 9, row-major; may be NULL); wb_solid_tip_tension()
 * gives the derivative with respect to the tension (9). */
void wb_solid_tip_forces(const double z[WB_SOLID_TIP_UNKNOWNS], const struct wb_tip_loads *loads,
                         const struct wb_solid_tip_strand *strand, double tension,
                         double phi[WB_SOLID_TIP_UNKNOWNS], double *derivative);
void wb_solid_tip_tension(const double z[WB_SOLID_TIP_UNKNOWNS],
                          const struct wb_solid_tip_strand *strand,
                          double direction[WB_SOLID_TIP_UNKNOWNS]);

#endif
