/* The tape of a bundle as shells (fe/swept/swept_tape.h).
 *
 * A sleeve is a closed ring on the outline, of all layers together, repeated at all stations. Of a
 * helix (fe/model/taping.h) the ring is what a station's plane cuts out of the strip: c / p times
 * round the outline, and turned on from station to station by C / p of their distance; its two ends
 * are the strip's edges. It begins on the wires; where it comes round again it lies on itself, one
 * thickness farther out, so that each winding lies on the one before as if wound from the clamp to
 * the tip. Both ends of the bundle cut the strip off. Meshes are refused whose flat elements lack
 * more than 2 % of the strip.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_TAPE_H
#define WB_FE_BUNDLE_BUNDLE_TAPE_H

#include "base/status.h"
#include "fe/bundle/bundle_body.h"
#include "fe/model/hull.h"

/* Ring and directors of bodies whose wires are made, with the state of their material, masses and
 * steps. Masses are means over all stations: parts take over those of the whole (NULL: these bodies
 * are the whole). */
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

/* At a station, `node` of the ring; or between two. */
struct wb_bundle_tape_place wb_bundle_tape_place(const struct wb_bundle_bodies *bodies, double node,
                                                 int station);

#endif
