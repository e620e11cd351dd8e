/* Places and stresses of a bundle at a moment of its run, as a mesh: for files that other programs
 * open, and for drawings.
 *
 * Bodies are the wires in their order, then the tape. Each has points of its own; point of section
 * node k at station j is first + j n_nodes + k. Cells are 8-node hexahedra of the wires, wire by
 * wire, and 4-node quadrilaterals of the tape.
 *
 * Stresses at points: the wire's tensors at the points of its elements are continued to the
 * elements' corners, the mean of those that meet taken, its von Mises stress made, and this kept to
 * the flow stress of the plastic strain there. The tape's are means of its elements' largest
 * through the thickness.
 */
#ifndef WB_FE_OUTPUT_BUNDLE_FIELDS_H
#define WB_FE_OUTPUT_BUNDLE_FIELDS_H

#include <stdbool.h>

#include "base/memory.h"
#include "fe/bundle/bundle.h"

struct wb_bundle_fields_body {
    bool is_tape;
    bool closed; /* the tape's ring; a wire's outline always is */
    int n_nodes, n_stations;
    int first;     /* point */
    int n_outline; /* of a wire: nodes round its section */
    int *outline;  /* (n_outline), owned */
};

struct wb_bundle_fields {
    int n_bodies;
    struct wb_bundle_fields_body *bodies; /* (n_bodies), owned, as all below */
    int n_points;
    double (*reference)[3]; /* (n_points), m */
    double (*position)[3];  /* (n_points), m */
    double *von_mises;      /* (n_points), Pa */
    double *plastic;        /* (n_points): equivalent plastic strain */
    int n_hexahedra, n_quads;
    int (*hexahedron)[8]; /* (n_hexahedra): points, the section's four at a station and at the next,
                             counter-clockwise seen against the axis */
    int (*quad)[4];       /* (n_quads): points, around */
    int *body;            /* (n_hexahedra + n_quads): of each cell */
    struct wb_memory memory; /* of all arrays */
};

/* The mesh of a bundle, with its present state. */
void wb_bundle_fields_init(struct wb_bundle_fields *fields, const struct wb_bundle *bundle);
/* The present state of the same bundle, or of another of the same model and mesh. Takes as long as
 * about ten steps. */
void wb_bundle_fields_take(struct wb_bundle_fields *fields, const struct wb_bundle *bundle);
void wb_bundle_fields_release(struct wb_bundle_fields *fields); /* accepts a zeroed one */

#endif
