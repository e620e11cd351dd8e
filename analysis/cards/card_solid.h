/* Cards of solid elements, as keywords of CalculiX and of Abaqus: density, elasticity, and plastic
 * tables of true stress over logarithmic plastic strain, for steps with NLGEOM.
 *
 * A law with isotropic hardening is one material with a table. Kinematic and mixed hardening, and
 * combined hardening of parallel parts, are parallel parts: each is a material, elastic and
 * perfectly plastic (combined: with a table that rises), of its own set of elements. The sets share
 * their nodes, so that the parts have the same strain and their stresses add up (Besseling's
 * overlay, as in fe/material/law.h). Parts on the same nodes have the same transverse strain too,
 * whether elastic or plastic. Therefore all have a Poisson's ratio close to that of plastic flow,
 * 0.49; otherwise they would constrain each other transversely.
 *
 * A table of Ludwik's curve consists of chords whose largest error is stated in the card; it ends
 * at a strain of 0.1, beyond which both programs keep the stress constant. Materials of a wire with
 * unknown mass (0) have no density.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_SOLID_H
#define WB_ANALYSIS_CARDS_CARD_SOLID_H

#include "analysis/cards/card.h"

/* As wb_card_kind.write. WB_ERR_UNSUPPORTED for a nearly incompressible material. */
WB_MUST_CHECK enum wb_status wb_card_solid_calculix(const struct wb_card_source *source,
                                                    const struct wb_card_settings *settings,
                                                    struct wb_text *text, struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_card_solid_abaqus(const struct wb_card_source *source,
                                                  const struct wb_card_settings *settings,
                                                  struct wb_text *text, struct wb_reason *why);

#endif
