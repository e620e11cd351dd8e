/* A point of a tape's wall: J2 plasticity with isotropic hardening by return mapping, in plane
 * stress, or as in a tube whose hoop stress is zero.
 *
 * The stresses are split in components t_k with q^2 = sum w_k t_k^2 (q: von Mises stress), each of
 * which is returned from its elastic trial value independently:
 *
 *     t_k = t_k* / (1 + g c_k),  q(g) = sigma_Y + H(p + g q),
 *
 * where g is the increment of the plastic strain p over q. In plane stress t = (s11 + s22, s11 -
 * s22, s12), w = (1/4, 3/4, 3), c = (E / (2 (1 - nu)), 3 G, 3 G); in a tube t = (s11, s12), w = (1,
 * 3), c = (E, 3 G). Source: J. C. Simo, R. L. Taylor, IJNME 22 (1986) 649. The slow twin is
 * tests/twin/bundle_static_sheet.h.
 */
#ifndef WB_FE_SECTION_SECTION_SHEET_H
#define WB_FE_SECTION_SECTION_SHEET_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material/material.h"

struct wb_section_sheet {
    const struct wb_material *material; /* borrowed */
    bool is_tube;                       /* no hoop stress; strain 22 is ignored */
    /* Set by wb_section_sheet_init(). */
    bool grows;              /* it yields */
    double modulus[3];       /* of the trial values of t */
    double weight[3], c[3];  /* see above */
    double flow_of_no_yield; /* Pa: sigma_Y; infinite if the material does not yield */
};

/* All zero is the virgin state. */
struct wb_section_sheet_state {
    double plastic[3];  /* 11, 22, twice 12 */
    double accumulated; /* p */
};

struct wb_section_sheet_response {
    double stress[3];     /* 11, 22, 12, Pa */
    double tangent[3][3]; /* consistent, symmetric, Pa */
};

/* WB_ERR_ARGUMENT for a material with kinematic hardening. */
WB_MUST_CHECK enum wb_status wb_section_sheet_init(struct wb_section_sheet *sheet,
                                                   const struct wb_material *material,
                                                   bool is_tube);

/* Response to the strains 11, 22, twice 12 from the history `before`. `after` is, on entry, an
 * initial guess of the new history (any finite values); it changes only the number of
 * iterations. */
void wb_section_sheet_respond(const struct wb_section_sheet *sheet, const double strain[3],
                              const struct wb_section_sheet_state *before,
                              struct wb_section_sheet_state *after,
                              struct wb_section_sheet_response *response);

#endif
