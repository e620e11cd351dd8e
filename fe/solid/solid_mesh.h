/* Meshes of 20-node hexahedra: the swept O-grid of a wire, and any other (tests).
 *
 * Nodes of an element are in the order of VTK's quadratic hexahedron (type 25), which is also that
 * of C3D20 in Abaqus and CalculiX: corners 0-3 of one face, 4-7 of the opposite one, then the
 * midside nodes 8-11 (edges 0-1, 1-2, 2-3, 3-0), 12-15 (4-5, 5-6, 6-7, 7-4), 16-19 (0-4, 1-5, 2-6,
 * 3-7). Faces with 8 nodes: corners 0-3 around, then the midside nodes 0-1, 1-2, 2-3, 3-0.
 *
 * Nodes are numbered in layers, from the clamp to the tip: an element touches nodes of at most two
 * consecutive layers, so that the stiffness is block tridiagonal. In layer l the nodes from link[l]
 * on share elements with layer l + 1; the nodes before share elements only with layers l and l - 1.
 * In a swept wire layer 0 is the clamped section, and layer l the nodes halfway along element slice
 * l - 1 followed by the section at its end.
 */
#ifndef WB_FE_SOLID_SOLID_MESH_H
#define WB_FE_SOLID_SOLID_MESH_H

#include "base/memory.h"
#include "base/status.h"

enum {
    WB_SOLID_MESH_NODES = 20, /* of an element */
    WB_SOLID_MESH_FACE = 8    /* of a face */
};

/* A face of an element. */
struct wb_solid_face {
    int node[WB_SOLID_MESH_FACE];
    int element;
};

/* Two faces of two parts that coincide in the reference configuration and may slide and separate:
 * node k of `inner` lies on node k of `outer`. Both are ordered so that the normal of `inner`
 * points out of the inner part, towards `outer`. */
struct wb_solid_pair {
    int inner[WB_SOLID_MESH_FACE], outer[WB_SOLID_MESH_FACE];
};

struct wb_solid_mesh {
    int n_nodes;
    double (*node)[3]; /* (n_nodes), m, reference positions; owned, like all arrays below */
    int n_elements;
    int (*element)[WB_SOLID_MESH_NODES]; /* (n_elements) */
    int *part;                           /* (n_elements), index of a part */
    int n_parts;
    int n_layers;
    int *layer; /* (n_layers + 1): layer l contains nodes layer[l] .. layer[l + 1] - 1 */
    int *link;  /* (n_layers): see above; link[n_layers - 1] is not used */
    int n_pairs;
    struct wb_solid_pair *pair; /* (n_pairs); 0 pairs if parts are bonded */

    /* Only in swept wires; 0 and NULL in other meshes. The wire's axis is x, from 0 to its length;
     * y and z span the section. */
    int n_clamp;
    int *clamp; /* (n_clamp), nodes of the section x = 0 */
    int n_tip_faces;
    struct wb_solid_face *tip_face; /* (n_tip_faces), all faces at the free end */
    int n_axis;
    int *axis; /* (n_axis), nodes on the axis from the clamp to the tip, including halfway nodes */
    struct wb_memory memory; /* of all arrays */
};

/* Description of a wire to sweep. Part 0 is a full circle, each further part a ring around the
 * previous one. */
struct wb_solid_mesh_wire {
    double length;            /* m */
    int n_parts;              /* 1 or 2 */
    double outer_diameter[2]; /* m, of each part */
    int elements_along;       /* at least 1 */
    int section_density; /* m >= 1: part 0 is a square of 2m x 2m elements within a ring of 8m x m;
                            each further part is a ring of 8m x m */
    int split; /* not 0: parts have their own nodes at their interface, and pairs of faces; 0: they
                  share nodes (bonded) */
};

/* Sweeps a conforming O-grid; midside nodes of curved edges lie on the circles, and the Jacobian is
 * positive at all corners. Mesh lines lie on the planes y = 0 and z = 0. WB_ERR_ARGUMENT for an
 * invalid wire. */
WB_MUST_CHECK enum wb_status wb_solid_mesh_sweep(struct wb_solid_mesh *mesh,
                                                 const struct wb_solid_mesh_wire *wire);

void wb_solid_mesh_release(struct wb_solid_mesh *mesh); /* accepts a zeroed one */

/* Faces on the plane z = 0 (the longitudinal section through the axis and y) from the side z > 0,
 * and faces of the section nearest to x (of the elements before it; at the clamp of those after
 * it). Allocated, owned by the caller (free). */
WB_MUST_CHECK enum wb_status wb_solid_mesh_longitudinal(const struct wb_solid_mesh *mesh,
                                                        struct wb_solid_face **faces, int *n);
WB_MUST_CHECK enum wb_status wb_solid_mesh_section(const struct wb_solid_mesh *mesh, double x,
                                                   struct wb_solid_face **faces, int *n);

#endif
