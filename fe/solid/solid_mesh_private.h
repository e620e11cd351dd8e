/* Functions of fe/solid/solid_mesh.c that only tests use. */
#ifndef WB_FE_SOLID_SOLID_MESH_PRIVATE_H
#define WB_FE_SOLID_SOLID_MESH_PRIVATE_H

#include "fe/solid/solid_mesh.h"

/* Allocates a mesh with one layer for the caller to fill in; all elements belong to part 0. */
WB_MUST_CHECK enum wb_status wb_solid_mesh_init(struct wb_solid_mesh *mesh, int n_nodes,
                                                int n_elements);

#endif
