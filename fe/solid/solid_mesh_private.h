/* What tests of fe/solid/solid_mesh.h ask beside it. */
#ifndef WB_FE_SOLID_SOLID_MESH_PRIVATE_H
#define WB_FE_SOLID_SOLID_MESH_PRIVATE_H

#include "fe/solid/solid_mesh.h"

/* Takes memory for a mesh of one layer to be filled in by the caller: part 0 everywhere, a
 * single layer. */
WB_MUST_CHECK enum wb_status wb_solid_mesh_init(struct wb_solid_mesh *mesh, int n_nodes,
                                                int n_elements);

/* Block of nx x ny x nz elements, each of 20 nodes, over the unit cube mapped by `map` (NULL: the
 * unit cube itself), layers along x. Beams, membranes, thick rings. */
WB_MUST_CHECK enum wb_status wb_solid_mesh_block(struct wb_solid_mesh *mesh, int nx, int ny, int nz,
                                                 void (*map)(void *context, const double unit[3],
                                                             double position[3]),
                                                 void *context);

#endif
