/* Functions of fe/solid/solid_mesh.c that only tests use. */
#ifndef WB_FE_SOLID_SOLID_MESH_PRIVATE_H
#define WB_FE_SOLID_SOLID_MESH_PRIVATE_H

#include "fe/solid/solid_mesh.h"

/* Allocates a mesh with one layer for the caller to fill in; all elements belong to part 0. */
WB_MUST_CHECK enum wb_status wb_solid_mesh_init(struct wb_solid_mesh *mesh, int n_nodes,
                                                int n_elements);

/* Block of nx x ny x nz elements with 20 nodes over the unit cube, mapped by `map` (NULL: not
 * mapped), layers along x. For beams, membranes, thick rings. */
WB_MUST_CHECK enum wb_status wb_solid_mesh_block(struct wb_solid_mesh *mesh, int nx, int ny, int nz,
                                                 void (*map)(void *context, const double unit[3],
                                                             double position[3]),
                                                 void *context);

#endif
