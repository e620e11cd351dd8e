/* A section prepared for computation: its fibres are sorted by material, its power laws tabulated,
 * and the plastic history of a section point is an array of doubles.
 *
 * Stresses agree with wb_material_stress() to about 1e-11 of the yield stress
 * (tests/twin/test_fibres_twin.c): p(c) comes from the table of fe/material/hardening.h, and points
 * that never yielded take a fast elastic path. The order of arithmetic is fixed, so results are
 * identical to the last bit for every vector width.
 */
#ifndef WB_FE_ROD_FIBRES_H
#define WB_FE_ROD_FIBRES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "fe/rod/section.h"

/* Stress resultants and tangent of a section: N = sum s A, M = -sum s A y. */
struct wb_fibres_response {
    double N, M;          /* N, N m */
    double D11, D12, D22; /* dN/d(eps), dN/d(kappa) = dM/d(eps), dM/d(kappa) */
};

/* The same in space, where a fibre's strain is eps - y kappa_z + z kappa_y: `plane` is of eps and
 * kappa_z, M_y = sum s A z, and the stiffnesses are dN, dM, dM_y over d(kappa_y). */
struct wb_fibres_space_response {
    struct wb_fibres_response plane;
    double M_y;           /* N m */
    double D1y, D2y, Dyy; /* N m, N m2, N m2 */
};

struct wb_fibres; /* opaque */

/* Sorts the section's fibres by material and tabulates its laws; does not keep a pointer to the
 * section. */
WB_MUST_CHECK enum wb_status wb_fibres_create(struct wb_fibres **out,
                                              const struct wb_section *section);
void wb_fibres_destroy(struct wb_fibres *fibres);

/* Replaces the materials (as many as the section has) and tabulates their laws again. */
void wb_fibres_set_materials(struct wb_fibres *fibres, const struct wb_material *materials);

/* Replaces the law of a section that was created with a law. The new law must be of the same kind
 * and need no more history rows: one for each part of kinematic or mixed hardening and for each
 * back stress, two for each part of combined hardening; otherwise WB_ERR_ARGUMENT. */
WB_MUST_CHECK enum wb_status wb_fibres_set_law(struct wb_fibres *fibres, const struct wb_law *law);

/* Duration of the following steps (s, 0 to infinity), during which the law's Maxwell elements
 * relax; infinite after creation. */
void wb_fibres_set_duration(struct wb_fibres *fibres, double duration);

/* Number of doubles in the history of one section point. All zero is the virgin state. */
size_t wb_fibres_history_size(const struct wb_fibres *fibres);

/* Elastic stiffnesses about the axis: axial EA (N), bending EI (N m2), shear (N; scaled with the
 * materials). */
double wb_fibres_axial_stiffness(const struct wb_fibres *fibres);
double wb_fibres_bending_stiffness(const struct wb_fibres *fibres);
double wb_fibres_shear_stiffness(const struct wb_fibres *fibres);

/* Response to axial strain and curvature from the history `before`. `after` (different memory)
 * receives the history at the end of the step. No side effects. */
void wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                       const double *restrict before, double *restrict after,
                       struct wb_fibres_response *restrict response);

/* The same in space, for a section without point laws. A history belongs to one of the two
 * functions. */
void wb_fibres_respond_in_space(const struct wb_fibres *fibres, double eps, double kappa_y,
                                double kappa_z, const double *restrict before,
                                double *restrict after,
                                struct wb_fibres_space_response *restrict response);

#endif
