/* The tape of a bundle as shells (fe/swept/swept_tape.h).
 *
 * A sleeve is a closed ring on the outline, the same at all stations, in which all layers are one
 * shell. The ring of a helix (fe/model/taping.h) is what the plane of a station cuts out of the
 * strip: it goes c / p times round the outline, its two ends are the edges of the strip, and from
 * station to station it turns by C / p of their distance. It begins on the wires; where it comes
 * round again it lies on itself, one thickness farther out: each winding lies on the one before, as
 * if wound from the clamp to the tip. The strip is cut off at both ends of the bundle. A mesh whose
 * flat elements lack more than 2 % of the strip is refused.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_TAPE_H
#define WB_FE_BUNDLE_BUNDLE_TAPE_H

#include "base/status.h"
#include "fe/bundle/bundle_body.h"
#include "fe/model/hull.h"

/* Adds ring and directors to bodies whose wires are made, with masses, integrators and the state of
 * the material. Masses are means over all stations, so the bodies of a part take over those of the
 * whole bundle; `whole` is NULL for the whole bundle itself. */
WB_MUST_CHECK enum wb_status wb_bundle_tape_create(struct wb_bundle_bodies *bodies,
                                                   const struct wb_bundle_bodies *whole);

/* A place on the tape. */
struct wb_bundle_tape_place {
    struct wb_hull_point point; /* of the outline through the middle of all layers */
    double level;   /* turns from the edge on the wires: 1 and more lies on other windings; 0 of a
                       sleeve */
    double outside; /* m: of the tape's middle from the point */
    bool is_tape;   /* false beyond the edges */
};

/* The place of a node of the ring at a station; a fraction lies between two nodes. */
struct wb_bundle_tape_place wb_bundle_tape_place(const struct wb_bundle_bodies *bodies, double node,
                                                 int station);

#endif
