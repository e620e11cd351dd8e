/* Blocks of 20-node hexahedra, for the tests of fe/solid: beams, membranes, thick rings. */
#ifndef WB_TESTS_FE_SOLID_BLOCK_MESH_H
#define WB_TESTS_FE_SOLID_BLOCK_MESH_H

#include <stdlib.h>

#include "fe/solid/solid_mesh_private.h"
#include "tests/check.h"

/* nx x ny x nz elements over the unit cube, mapped by `map` (NULL: not mapped), layers along x. */
static inline void
test_block_mesh(struct wb_solid_mesh *mesh, int nx, int ny, int nz,
                void (*map)(void *context, const double unit[3], double position[3]), void *context)
{
    /* Half element steps from an element's first corner to its nodes. */
    static const int step[WB_SOLID_MESH_NODES][3] = {
        {0, 0, 0}, {0, 2, 0}, {0, 2, 2}, {0, 0, 2}, {2, 0, 0}, {2, 2, 0}, {2, 2, 2},
        {2, 0, 2}, {0, 1, 0}, {0, 2, 1}, {0, 1, 2}, {0, 0, 1}, {2, 1, 0}, {2, 2, 1},
        {2, 1, 2}, {2, 0, 1}, {1, 0, 0}, {1, 2, 0}, {1, 2, 2}, {1, 0, 2},
    };
    const int cy = 2 * ny + 1, cz = 2 * nz + 1, corners = (ny + 1) * (nz + 1);
    const int in_section = cy * cz - ny * nz;
    int *const number = calloc((size_t)((2 * nx + 1) * cy * cz), sizeof *number);
    int n = 0;

    assert_non_null(number);
    assert_int_equal(wb_solid_mesh_init(mesh, (nx + 1) * in_section + nx * corners, nx * ny * nz),
                     WB_OK);
    mesh->n_layers = nx + 1;
    mesh->layer = wb_memory_take(&mesh->memory, (size_t)nx + 2, sizeof *mesh->layer);
    mesh->link = wb_memory_take(&mesh->memory, (size_t)nx + 1, sizeof *mesh->link);
    for (int l = 0; l <= 2 * nx; l++) {
        if (l % 2 == 0)
            mesh->link[l / 2] = n;
        for (int k = 0; k < cy * cz; k++) {
            const int i = k / cz, j = k % cz;
            const double unit[3] = {l / (2.0 * nx), i / (2.0 * ny), j / (2.0 * nz)};
            if (l % 2 + i % 2 + j % 2 > 1)
                continue;
            for (int c = 0; c < 3; c++)
                mesh->node[n][c] = unit[c];
            if (map)
                map(context, unit, mesh->node[n]);
            number[l * cy * cz + k] = n++;
        }
        if (l % 2 == 0)
            mesh->layer[l / 2 + 1] = n;
    }
    for (int e = 0; e < nx * ny * nz; e++)
        for (int a = 0; a < WB_SOLID_MESH_NODES; a++) {
            const int l = 2 * (e / (ny * nz)) + step[a][0];
            const int i = 2 * (e / nz % ny) + step[a][1], j = 2 * (e % nz) + step[a][2];
            mesh->element[e][a] = number[(l * cy + i) * cz + j];
        }
    free(number);
}

#endif
