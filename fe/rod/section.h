/* Fibre section of a round beam: axial fibres with offset, area and material.
 *
 * Strip fibres at Gauss-Chebyshev points (second kind) over the diameter: with y_i = R cos t_i,
 * t_i = i pi / (n + 1), the strip areas 2 R^2 sin^2(t_i) pi / (n + 1) integrate the circle's
 * moments exactly up to degree 2 n - 1 (see reference table in docs/verification.md for how many
 * points a plastic curve needs).
 */
#ifndef WB_FE_ROD_SECTION_H
#define WB_FE_ROD_SECTION_H

#include "base/status.h"
#include "fe/material/law.h"
#include "fe/material/material.h"

struct wb_fibre {
    double y;     /* m, offset from the axis; a fibre's strain is eps - y kappa */
    double area;  /* m2 */
    int material; /* index into the section's materials */
    double z;     /* m, the other offset; counts in space only */
};

/* A stress-strain law for wires that the laws of fe/material/hardening.h cannot describe, such as
 * the virtual rig's; borrowed by the section. It is evaluated fibre by fibre, which is slow. */
struct wb_point_law {
    int n_history; /* doubles in a point's history; all zero is the virgin state */
    /* Stress (Pa) and tangent modulus at a strain from the history `before`; `after` receives the
     * history at the end of the step. No side effects. */
    void (*respond)(const void *context, double strain, const double *before, double *after,
                    double *stress, double *tangent);
    const void *context;
};

struct wb_section {
    int n_fibres;
    struct wb_fibre *fibres; /* (n_fibres), owned */
    int n_materials;
    struct wb_material *materials; /* (n_materials), owned */
    double shear_stiffness;        /* G A k, N, elastic */
    /* NULL: each fibre uses its material's law. Otherwise all fibres use this law, and the only
     * material gives the shear stiffness; owned. */
    struct wb_law *law;
    /* NULL, or a law for each material that replaces the material's own law; the material then
     * gives only the elastic stiffness; (n_materials), borrowed. */
    const struct wb_point_law *point_laws;
};

/* Solid circle of one material with n strips (0: 20). */
WB_MUST_CHECK enum wb_status wb_section_init_circle(struct wb_section *section, double diameter,
                                                    const struct wb_material *material, int n);

/* Solid circle of a law with n strips (0: 20); WB_ERR_ARGUMENT for an invalid law. */
WB_MUST_CHECK enum wb_status wb_section_init_law(struct wb_section *section, double diameter,
                                                 const struct wb_law *law, int n);

/* The same for a rod in space: fibres in `n_rings` rings of `n_around` (a multiple of 4) fibres. */
WB_MUST_CHECK enum wb_status wb_section_init_law_in_space(struct wb_section *section,
                                                          double diameter, const struct wb_law *law,
                                                          int n_rings, int n_around);

/* An empty section for wb_section_add_ring(); each part adds to the shear stiffness. */
void wb_section_init_empty(struct wb_section *section);

/* Adds a solid circle (inner_diameter = 0) or a ring of `material`. Only `area_fraction` (0..1] of
 * its area carries load, so that several laws in parallel (an overlay) can share one region. n
 * strips over the outer diameter (0: 20). */
WB_MUST_CHECK enum wb_status wb_section_add_ring(struct wb_section *section, double inner_diameter,
                                                 double outer_diameter,
                                                 const struct wb_material *material,
                                                 double area_fraction, int n);

/* Shear modulus G times the circle's shear factor (Cowper), Pa: contribution of one m2 of
 * `material` to shear_stiffness. */
double wb_section_shear_modulus(const struct wb_material *material);

/* Checks a material; WB_ERR_ARGUMENT with a logged message if its parameters are invalid. */
WB_MUST_CHECK enum wb_status wb_section_check_material(const struct wb_material *material);

/* Frees what the section owns; accepts a zeroed section. */
void wb_section_release(struct wb_section *section);

#endif
