/* The section of a taped bundle for the section model (fe/section/section_beam.h): unknowns of a
 * station along the bundle, wires, nodes and segments of the tape, bonds, contacts.
 *
 * Unknowns of a station: 0 is the rotation of the section, then the slip along the axis of each
 * wire, then the warp of each tape node. If the section is symmetric about the plane of bending (z
 * -> -z), images share their unknown and one of them represents both, with weight 2.
 *
 * Tape nodes lie on its middle line: equally spaced on each arc, with an odd number of at least
 * three; on a straight piece, or around a circle, at most 1.2 mm apart.
 */
#ifndef WB_FE_SECTION_SECTION_LAYOUT_H
#define WB_FE_SECTION_SECTION_LAYOUT_H

#include <stdbool.h>

#include "base/memory.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"

/* A wire, or a pair of image wires. */
struct wb_section_wire {
    int type;      /* of the model */
    int unknown;   /* of its slip */
    double y, z;   /* m */
    double weight; /* 1 or 2 */
};

/* A segment of the tape between two nodes. */
struct wb_section_segment {
    int unknown[2];   /* of its nodes' warp, in the outline's direction */
    double y;         /* m, mean height */
    double length;    /* m */
    double thickness; /* m */
    double weight;    /* 1 or 2 */
};

struct wb_section_bond {
    int unknown[2];   /* of the node's warp, of the wire's slip */
    double stiffness; /* Pa: K_ss times its width and weight */
};

/* Two wires in contact, or a pair of images of them. */
struct wb_section_contact {
    int unknown[2]; /* of their slips; equal if the contact cannot slip */
    double weight;  /* 1 or 2 */
};

/* Force of a tape segment on a wire: a share of its axial force times the curvature, and its hoop
 * force. */
struct wb_section_pull {
    int wire, segment; /* indices in the lists */
    double share;      /* of the axial force of one of the segment's images, 0 to 1 */
    double y, z;       /* unit vector of the hoop force; zero: no hoop force */
};

struct wb_section_layout {
    bool is_mirrored;
    int n_unknowns; /* of a station */
    int n_wires, n_segments, n_bonds, n_contacts, n_pulls;
    struct wb_section_wire *wires;
    struct wb_section_segment *segments;
    struct wb_section_bond *bonds;
    struct wb_section_contact *contacts;
    struct wb_section_pull *pulls;
    /* Equilibrium of the wires in the plane of the section: equation 2 w is that of wire w upwards,
     * 2 w + 1 sideways. (2 n_wires x n_contacts) N on a wire for a unit force of a contact and its
     * image. */
    double *balance;
    int n_packing;       /* number of wires of the packing */
    double bonded_width; /* m, of all bonds */
    struct wb_memory memory;
};

enum {
    WB_SECTION_LAYOUT_MOST_NODES = 4 * WB_HULL_MOST /* of the tape */
};

/* Checks that the section model supports this bundle. WB_ERR_UNSUPPORTED, with the reason, for tape
 * wound as a helix, wires of several diameters, gaps between neighbours above 0.01 mm, bonds that
 * may break, and a potted length. */
WB_MUST_CHECK enum wb_status wb_section_layout_check(const struct wb_bundle_model *model,
                                                     struct wb_reason *why);

/* Creates the layout for a model that passes the check. Without `may_mirror` images have unknowns
 * of their own. */
WB_MUST_CHECK enum wb_status wb_section_layout_create(struct wb_section_layout *layout,
                                                      const struct wb_bundle_model *model,
                                                      bool may_mirror);
void wb_section_layout_release(struct wb_section_layout *layout); /* accepts a zeroed one */

#endif
