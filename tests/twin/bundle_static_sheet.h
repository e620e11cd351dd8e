/* A material point of a sheet in plane stress: J2 plasticity with the power law of
 * fe/material/material.h, by return mapping.
 *
 * With a = s11 + s22, b = s11 - s22 and q^2 = a^2/4 + 3 b^2/4 + 3 s12^2 the trial stresses shrink
 * each on its own, g being the increment of plastic strain over q:
 *
 *     a = a* / (1 + g E / (2 (1 - nu))),  b = b* / (1 + 3 G g),  s12 = s12* / (1 + 3 G g),
 *
 * and g solves q(g) = sigma_Y + K (p + g q(g))^n. Source: J. C. Simo, R. L. Taylor, IJNME 22 (1986)
 * 649.
 */
#ifndef WB_TESTS_TWIN_BUNDLE_STATIC_SHEET_H
#define WB_TESTS_TWIN_BUNDLE_STATIC_SHEET_H

#include "fe/material/material.h"

struct wb_bundle_static_sheet {
    struct wb_material material; /* elastic or isotropic power law */
};

/* All zero is the virgin state. */
struct wb_bundle_static_sheet_state {
    double plastic[3]; /* 11, 22, twice 12 */
    double accumulated;
};

struct wb_bundle_static_sheet_response {
    double stress[3];     /* 11, 22, 12, Pa */
    double tangent[3][3]; /* consistent, symmetric, Pa */
};

/* Response to the strains 11, 22, twice 12 from the history `before`. Pure. */
void wb_bundle_static_sheet_respond(const struct wb_bundle_static_sheet *sheet,
                                    const double strain[3],
                                    const struct wb_bundle_static_sheet_state *before,
                                    struct wb_bundle_static_sheet_state *after,
                                    struct wb_bundle_static_sheet_response *response);

#endif
