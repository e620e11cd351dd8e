/* Positions and stresses of a bundle at one time of its run, as a mesh: for files that other
 * programs open, and for drawings.
 *
 * Bodies are the wires in their order, then the tape. Each has its own points; section node k at
 * station j is point first + j n_nodes + k. Cells are 8-node hexahedra of the wires, wire by wire,
 * and 4-node quadrilaterals of the tape.
 *
 * Stresses at points: the wire's stress tensors at the integration points are extrapolated to the
 * elements' corners and averaged over adjacent elements; the von Mises stress of the mean is
 * limited to the flow stress at the point's plastic strain. For the tape the values are means over
 * adjacent elements of the largest stress through the thickness.
 */
#ifndef WB_FE_OUTPUT_BUNDLE_FIELDS_H
#define WB_FE_OUTPUT_BUNDLE_FIELDS_H

#include <stdbool.h>

#include "base/memory.h"
#include "fe/bundle/bundle.h"

struct wb_bundle_fields_body {
    bool is_tape;
    bool closed; /* the tape's ring is closed; always true for a wire's outline */
    int n_nodes, n_stations;
    int first;     /* point */
    int n_outline; /* wires: number of nodes around the section */
    int *outline;  /* (n_outline), owned */
};

struct wb_bundle_fields {
    int n_bodies;
    struct wb_bundle_fields_body *bodies; /* (n_bodies), owned, like all arrays below */
    int n_points;
    double (*reference)[3]; /* (n_points), m */
    double (*position)[3];  /* (n_points), m */
    double *von_mises;      /* (n_points), Pa */
    double *plastic;        /* (n_points): equivalent plastic strain */
    int n_hexahedra, n_quads;
    int (*hexahedron)[8]; /* (n_hexahedra): points, four of the section at a station and four at the
                             next, counter-clockwise seen against the axis */
    int (*quad)[4];       /* (n_quads): points, around */
    int *body;            /* (n_hexahedra + n_quads): body of each cell */
    struct wb_memory memory; /* of all arrays */
};

/* Creates the mesh of a bundle, with its current state. */
void wb_bundle_fields_init(struct wb_bundle_fields *fields, const struct wb_bundle *bundle);
/* Updates the state from the same bundle, or from another one of the same model and mesh. Costs as
 * much as about ten steps. */
void wb_bundle_fields_take(struct wb_bundle_fields *fields, const struct wb_bundle *bundle);
void wb_bundle_fields_release(struct wb_bundle_fields *fields); /* accepts a zeroed one */

#endif
