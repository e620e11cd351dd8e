/* The round section of a rod in space that bends by a law of fe/material/law.h: fibres in rings
 * carry axial stress; twist and transverse shear are elastic.
 *
 * Strains e, kx, ky, kz and forces N, Mx, My, Mz as in fe/rod/rod_section.h; Mx = GJ kx.
 */
#ifndef WB_FE_ROD_LAW_SECTION_H
#define WB_FE_ROD_LAW_SECTION_H

#include <stddef.h>

#include "base/status.h"
#include "fe/material/law.h"
#include "fe/rod/rod_section.h"

struct wb_law_section_model {
    double diameter; /* m */
    const struct wb_law *law;
    double torsional_stiffness;          /* GJ, N m2; 0: EI / (1 + nu) of the law */
    struct wb_rod_section_layout fibres; /* 0: 8 rings of 24 fibres */
};

struct wb_law_section; /* opaque */

/* On failure *out is NULL. Keeps nothing of the model. */
WB_MUST_CHECK enum wb_status wb_law_section_create(struct wb_law_section **out,
                                                   const struct wb_law_section_model *model);
void wb_law_section_destroy(struct wb_law_section *section); /* accepts NULL */

/* Number of doubles in the history of one section point. All zero is the virgin state. */
size_t wb_law_section_history_size(const struct wb_law_section *section);

/* Elastic stiffnesses: axial EA (N), bending EI, torsion GJ (N m2), transverse shear (N). */
struct wb_law_section_stiffness {
    double axial, bending, torsion, shear;
};
struct wb_law_section_stiffness wb_law_section_stiffness(const struct wb_law_section *section);

/* Response to the strains from the history `before`. `after` (different memory) receives the
 * history at the end of the step. No side effects. */
void wb_law_section_respond(const struct wb_law_section *section, const double *strain,
                            const double *restrict before, double *restrict after,
                            struct wb_rod_section_response *restrict response);

#endif
