/* The homogenised beam that bends like a cantilever: its moment over curvature from force and
 * deflection of the tip.
 *
 * A beam whose curvature is one function of the moment, loaded by a vertical force F at its tip
 * without weight, has M = F (x_tip - x). Each further row of a loading brings one further moment at
 * the clamp, where its curve goes on straight from the row before; the slope there follows from the
 * deflection. Its M over kappa and E I are those of a bundle of this length and these ends: another
 * length shears otherwise and has others.
 */
#ifndef WB_FE_SECTION_SECTION_HOMOGENISE_H
#define WB_FE_SECTION_SECTION_HOMOGENISE_H

/* A point of the loading, and what the homogenised beam has at its clamp then. */
struct wb_section_homogenise_point {
    double deflection, force; /* m, N: given, ascending, beyond zero */
    double curvature, moment; /* 1/m, N m: found */
};

/* Fills in curvatures and moments of n points of a loading from zero, for a length (m). Returns how
 * many: the curve ends where the moment at the clamp does not grow any more, or no curvature gives
 * the deflection. */
int wb_section_homogenise(int n, struct wb_section_homogenise_point *points, double length);

#endif
