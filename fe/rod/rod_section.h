/* The round section of a rod in space, made of fibres in concentric rings that carry axial stress
 * and the shear stress of torsion (fe/rod/rod_fibre.h); transverse shear is elastic.
 *
 * Axes: x along the rod, y and z in the section. With axial strain e, twist kx and curvatures ky,
 * kz (material components: rates of turning about x, y, z) a fibre at (y, z), r = |(y, z)|, has
 *
 *     strain e + z ky - y kz,  shear angle r kx along the ring;
 *     N = sum s A,  Mx = sum t r A,  My = sum s z A,  Mz = -sum s y A.
 *
 * The rings sit at Gauss-Legendre points of r^2 over each part, so that area, second moments and
 * torsion constant are exact. The fibres of a ring are equally spaced, and every other ring is
 * turned by half the angle between two fibres.
 */
#ifndef WB_FE_ROD_ROD_SECTION_H
#define WB_FE_ROD_ROD_SECTION_H

#include <stddef.h>

#include "base/status.h"
#include "fe/material/material.h"

enum {
    WB_ROD_SECTION_STRAINS = 4 /* e, kx, ky, kz, and their forces N, Mx, My, Mz */
};

/* A solid circle (inner_diameter = 0) or ring. */
struct wb_rod_section_part {
    double inner_diameter, outer_diameter; /* m */
    struct wb_material material;
};

struct wb_rod_section_layout {
    int n_rings;  /* in each part; 0: 8 */
    int n_around; /* fibres in a ring, a multiple of 4; 0: 24 */
};

/* A fibre and its cell, the sector of the ring that it represents. */
struct wb_rod_section_fibre {
    double y, z;                       /* m */
    double inner_radius, outer_radius; /* m */
    double begin_angle, end_angle;     /* rad, from y towards z */
    double area;                       /* m2 */
    int part;
};

struct wb_rod_section_response {
    double force[WB_ROD_SECTION_STRAINS];
    double tangent[WB_ROD_SECTION_STRAINS][WB_ROD_SECTION_STRAINS]; /* symmetric */
    int yielding; /* number of fibres that yield in this step */
};

struct wb_rod_section; /* opaque */

/* `layout` may be NULL. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_rod_section_create(struct wb_rod_section **out, int n_parts,
                                                   const struct wb_rod_section_part *parts,
                                                   const struct wb_rod_section_layout *layout);
void wb_rod_section_destroy(struct wb_rod_section *section); /* accepts NULL */

int wb_rod_section_fibres(const struct wb_rod_section *section);
void wb_rod_section_fibre(const struct wb_rod_section *section, int i,
                          struct wb_rod_section_fibre *fibre);

/* Number of doubles in the history of one section point. All zero is the virgin state. */
size_t wb_rod_section_history_size(const struct wb_rod_section *section);

/* Elastic stiffnesses about the axis, N, N m2: axial EA, bending EI, and transverse shear with
 * Cowper's factor. */
double wb_rod_section_axial_stiffness(const struct wb_rod_section *section);
double wb_rod_section_bending_stiffness(const struct wb_rod_section *section);
double wb_rod_section_shear_stiffness(const struct wb_rod_section *section);

/* Response to the strains from the history `before`. `after` (different memory) receives the
 * history at the end of the step. No side effects. */
void wb_rod_section_respond(const struct wb_rod_section *section, const double *strain,
                            const double *restrict before, double *restrict after,
                            struct wb_rod_section_response *restrict response);

/* Stresses of fibre i and its equivalent plastic strain, at the strains that belong to
 * `history`. */
void wb_rod_section_stress(const struct wb_rod_section *section, int i, const double *strain,
                           const double *history, double *axial, double *shear, double *plastic);

#endif
