/* The card for MuJoCo: an MJCF model of a clamped wire as a chain of rigid segments (card_chain.h)
 * with two bending hinges and a twist hinge per joint.
 *
 * The engine's joints are linear springs: the card has one stiffness, of the virgin wire or the
 * secant at a curvature, and no residual curvature; the card states this, and that torsion and
 * damping are assumptions. The engine's cable plugin and ball joints are not used: ball joints have
 * the same stiffness about all axes.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_MUJOCO_H
#define WB_ANALYSIS_CARDS_CARD_MUJOCO_H

#include "analysis/cards/card.h"

/* As wb_card_kind.write. WB_ERR_UNSUPPORTED for segments whose inertia the engine rejects. */
WB_MUST_CHECK enum wb_status wb_card_mujoco(const struct wb_card_source *source,
                                            const struct wb_card_settings *settings,
                                            struct wb_text *text, struct wb_reason *why);

#endif
