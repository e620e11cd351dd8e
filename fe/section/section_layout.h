/* The section of a taped bundle as the section model (fe/section/section_beam.h) computes with it:
 * unknowns of a station along the bundle, wires, nodes and segments of the tape, bonds, contacts.
 *
 * Unknowns of a station: 0 is the rotation of the section, then the slip along the axis of each
 * wire, then the warp of each tape node. Where the section is its own mirror image in the plane of
 * bending (z -> -z), images share their unknown and one of them stands for both, with weight 2.
 *
 * Tape nodes lie in its middle: on each arc in equal steps with an odd number of nodes, at least
 * three; on a straight piece, or round a circle, at most 1.2 mm apart.
 */
#ifndef WB_FE_SECTION_SECTION_LAYOUT_H
#define WB_FE_SECTION_SECTION_LAYOUT_H

#include <stdbool.h>

#include "base/memory.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"

/* A wire, or a pair of images. */
struct wb_section_wire {
    int wire;      /* of the packing */
    int type;      /* of the model */
    int unknown;   /* of its slip */
    double y, z;   /* m */
    double weight; /* 1 or 2 */
};

/* A piece of the tape between two nodes. */
struct wb_section_segment {
    int unknown[2];   /* of its nodes' warp, in the outline's direction */
    double y;         /* m, mean height */
    double length;    /* m */
    double thickness; /* m */
    double weight;    /* 1 or 2 */
};

struct wb_section_bond {
    int unknown[2];   /* of the node's warp, of the wire's slip */
    double stiffness; /* Pa: K_ss times its width, with its weight */
};

/* Wires that touch, or a pair of images of them. */
struct wb_section_contact {
    int unknown[2]; /* of their slips; the same where nothing can slip */
    double weight;  /* 1 or 2 */
};

/* What a piece of tape does to a wire: the curvature presses a share of its axial force on it, and
 * its hoop force pulls it. */
struct wb_section_pull {
    int wire, segment; /* places in the lists */
    double share;      /* of the axial force of one of the segment's images, 0 to 1 */
    double y, z;       /* unit vector of the hoop force; zero: none acts */
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
     * 2 w + 1 across. (2 n_wires x n_contacts) N of a wire by a unit force of a contact and its
     * image. */
    double *balance;
    int n_packing;       /* wires of the packing */
    double bonded_width; /* m, of all bonds */
    struct wb_memory memory;
};

enum {
    WB_SECTION_LAYOUT_MOST_NODES = 4 * WB_HULL_MOST /* of the tape */
};

/* Whether the section model is made for this bundle. WB_ERR_UNSUPPORTED, with the reason, for what
 * it cannot compute: tape wound as a helix, wires of several diameters, gaps between neighbours
 * above 0.01 mm, bonds that may break, a potted length. */
WB_MUST_CHECK enum wb_status wb_section_layout_check(const struct wb_bundle_model *model,
                                                     struct wb_reason *why);

/* Lays out the section of a model that passes the check; without `may_mirror` images have unknowns
 * of their own. */
WB_MUST_CHECK enum wb_status wb_section_layout_create(struct wb_section_layout *layout,
                                                      const struct wb_bundle_model *model,
                                                      bool may_mirror);
void wb_section_layout_release(struct wb_section_layout *layout); /* accepts a zeroed one */

#endif
