/* Adds an increment to the displacements of a slender wire without stretching it.
 *
 * A linear increment moves a rotating section along its tangent, which lengthens the wire by half
 * the square of the rotation and causes very large axial forces in the next Newton iteration. A
 * swept wire's increment is therefore split, section by section, into a rotation and a remainder;
 * rotations are applied as finite rotations to the sections and to the chords between them. To
 * first order this is the linear increment, so Newton's method keeps its order; it needs about half
 * the iterations. Other meshes are updated linearly.
 */
#ifndef WB_FE_SOLID_SOLID_UPDATE_H
#define WB_FE_SOLID_SOLID_UPDATE_H

#include "fe/solid/solid_mesh.h"

struct wb_solid_update_section {
    double centre[3];   /* m */
    double rotation[3]; /* rad */
    double moved[3];    /* the centre after an extrapolation, m */
    double shift[3];    /* of the centre, in an update, m */
};

struct wb_solid_update {
    const struct wb_solid_mesh *mesh; /* borrowed */
    int n_sections;                   /* planes of nodes along the wire; 0: not swept */
    int *first;                       /* (n_sections + 1) into `node` */
    int *node;                        /* (n_nodes), by section */
    struct wb_solid_update_section *section;
};

void wb_solid_update_init(struct wb_solid_update *update, const struct wb_solid_mesh *mesh);
void wb_solid_update_release(struct wb_solid_update *update); /* accepts a zeroed one */

/* u (3 n_nodes) moves by `scale` times `increment`. */
void wb_solid_update_advance(struct wb_solid_update *update, double *u, const double *increment,
                             double scale);

/* `next` = the motion from `before` to `now`, extrapolated by `ratio` times itself. */
void wb_solid_update_extrapolate(struct wb_solid_update *update, const double *before,
                                 const double *now, double ratio, double *next);

#endif
