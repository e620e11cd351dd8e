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
};

/* A stress-strain law that a section borrows, for wires richer than the laws of
 * fe/material/hardening.h: the virtual rig's. It is asked fibre by fibre, which is slow. */
struct wb_point_law {
    int n_history; /* doubles of a point; all zero is the virgin state */
    /* Stress (Pa) and its slope at a strain, from the history `before`; `after` receives the
     * history if the step is accepted. Pure. */
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
    /* NULL: the fibres have their materials' own laws. Else all fibres have this one, and the only
     * material says their shear stiffness; owned. */
    struct wb_law *law;
    /* NULL, or a law for each material instead of the material's own, which then says the elastic
     * stiffness; (n_materials), borrowed. */
    const struct wb_point_law *point_laws;
};

/* Solid circle of one material with n strips (0: 20). */
WB_MUST_CHECK enum wb_status wb_section_init_circle(struct wb_section *section, double diameter,
                                                    const struct wb_material *material, int n);

/* Solid circle of a law with n strips (0: 20); WB_ERR_ARGUMENT for what makes no law. */
WB_MUST_CHECK enum wb_status wb_section_init_law(struct wb_section *section, double diameter,
                                                 const struct wb_law *law, int n);

/* An empty section to be filled with wb_section_add_ring(); shear stiffness starts at zero and
 * grows with each part. */
void wb_section_init_empty(struct wb_section *section);

/* Adds a solid circle (inner_diameter = 0) or a ring of `material`, of which only `area_fraction`
 * (0..1] takes part, so that several laws in parallel (an overlay) can share one region. n strips
 * over the outer diameter (0: 20). */
WB_MUST_CHECK enum wb_status wb_section_add_ring(struct wb_section *section, double inner_diameter,
                                                 double outer_diameter,
                                                 const struct wb_material *material,
                                                 double area_fraction, int n);

/* G times the circle's shear factor (Cowper), Pa: what one m2 of `material` adds to
 * shear_stiffness. */
double wb_section_shear_modulus(const struct wb_material *material);

/* Refuses a material whose numbers make no law. */
WB_MUST_CHECK enum wb_status wb_section_check_material(const struct wb_material *material);

/* Frees what the section owns; accepts a zeroed section. */
void wb_section_release(struct wb_section *section);

#endif
