/* The card for MuJoCo: an MJCF model of a clamped wire as a chain of rigid segments (card_chain.h)
 * on two bending hinges and a twist hinge a joint.
 *
 * The engine's joints are linear springs: the card holds one stiffness, that of the virgin wire or
 * the secant at a curvature, and never the residual curvature; it says so. Torsion and damping are
 * assumptions, and said to be. Cables of the engine's plugin, and ball joints, which have one
 * stiffness about all axes, are not used.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_MUJOCO_H
#define WB_ANALYSIS_CARDS_CARD_MUJOCO_H

#include "analysis/cards/card.h"

/* As wb_card_kind.write. WB_ERR_UNSUPPORTED for segments whose inertia the engine refuses. */
WB_MUST_CHECK enum wb_status wb_card_mujoco(const struct wb_card_source *source,
                                            const struct wb_card_settings *settings,
                                            struct wb_text *text, struct wb_reason *why);

#endif
