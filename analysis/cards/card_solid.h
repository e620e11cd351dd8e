/* Cards of solid elements, as keywords of CalculiX and of Abaqus: density, elasticity, and plastic
 * tables of true stress over logarithmic plastic strain, for steps with NLGEOM.
 *
 * A law with isotropic hardening is one material with a table. Kinematic and mixed hardening, and
 * combined hardening of parallel parts, are parallel parts: each a material, elastic and perfectly
 * plastic (combined: with a table that rises), of its own set of elements; the sets have the same
 * nodes, so that the parts share the strain and their stresses add (Besseling's overlay, as
 * fe/material/law.h has it). Parts that share nodes share the strain across the wire as well,
 * elastic or plastic; so all have a Poisson's ratio close to that of plastic flow, 0.49, or they
 * would press upon each other across.
 *
 * A table of Ludwik's curve is a chain of chords that lies at most the error that the card states
 * below it; it ends at a strain of 0.1, beyond which both programs keep the stress.
 * Of a wire whose mass is unknown (0) the materials have no density.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_SOLID_H
#define WB_ANALYSIS_CARDS_CARD_SOLID_H

#include "analysis/cards/card.h"

/* As wb_card_kind.write. WB_ERR_UNSUPPORTED for a material that is as good as incompressible. */
WB_MUST_CHECK enum wb_status wb_card_solid_calculix(const struct wb_card_source *source,
                                                    const struct wb_card_settings *settings,
                                                    struct wb_text *text, struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_card_solid_abaqus(const struct wb_card_source *source,
                                                  const struct wb_card_settings *settings,
                                                  struct wb_text *text, struct wb_reason *why);

#endif
