/* The tape of a bundle as shells (fe/swept/swept_tape.h).
 *
 * A sleeve is a closed ring on the outline, the same at all stations, in which all layers are one
 * shell. The ring of a helix (fe/model/taping.h) is the intersection of the strip with the plane of
 * a station: it goes c / p times around the outline, its two ends are the edges of the strip, and
 * from station to station it rotates by C / p of their distance. It begins on the wires; after one
 * turn it lies on itself, one thickness farther out: each winding lies on the previous one, as if
 * wound from the clamp to the tip. The strip is cut off at both ends of the bundle. A mesh whose
 * flat elements miss more than 2 % of the strip's mass is rejected.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_TAPE_H
#define WB_FE_BUNDLE_BUNDLE_TAPE_H

#include "base/status.h"
#include "fe/bundle/bundle_body.h"
#include "fe/model/hull.h"

/* Adds ring and directors, with masses, integrators and material states, to bodies that already
 * have wires. Masses are means over all stations, so the bodies of a part take them from the
 * complete bundle; `whole` is NULL for the complete bundle itself. */
WB_MUST_CHECK enum wb_status wb_bundle_tape_create(struct wb_bundle_bodies *bodies,
                                                   const struct wb_bundle_bodies *whole);

/* A position on the tape. */
struct wb_bundle_tape_place {
    struct wb_hull_point point; /* on the outline through the middle of all layers */
    double level; /* turns from the edge on the wires: from 1 on the tape lies on other windings; 0
                     for a sleeve */
    double outside; /* distance of the tape's middle from the point, m */
    bool is_tape;   /* false beyond the edges */
};

/* The position of a node of the ring at a station; a fraction lies between two nodes. */
struct wb_bundle_tape_place wb_bundle_tape_place(const struct wb_bundle_bodies *bodies, double node,
                                                 int station);

#endif
