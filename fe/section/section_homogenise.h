/* The homogenised beam: the moment-curvature curve of a cantilever that has a given tip force over
 * deflection.
 *
 * A beam whose curvature is a function of the moment only, loaded by a vertical force F at its tip
 * without weight, has M = F (x_tip - x). Each further point of a loading adds one moment at the
 * clamp, up to which the curve is continued linearly; its slope follows from the deflection. The
 * resulting M over kappa and E I are valid for a bundle of this length and these ends only, because
 * the shear between wires depends on the length.
 */
#ifndef WB_FE_SECTION_SECTION_HOMOGENISE_H
#define WB_FE_SECTION_SECTION_HOMOGENISE_H

/* A point of a loading, and the state at the clamp of the homogenised beam. */
struct wb_section_homogenise_point {
    double deflection, force; /* m, N: input, ascending, above zero */
    double curvature, moment; /* 1/m, N m: found */
};

/* Computes curvatures and moments of n points of a loading from zero, for a length (m). Returns the
 * number of points computed: the curve ends where the moment at the clamp stops increasing or no
 * curvature gives the deflection. */
int wb_section_homogenise(int n, struct wb_section_homogenise_point *points, double length);

#endif
