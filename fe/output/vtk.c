#include "fe/output/vtk.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "fe/output/vtk_private.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    CELL_NODES = WB_SOLID_MESH_NODES,
    QUADRATIC_HEXAHEDRON = 25, /* VTK's number; its order of nodes is ours */
    BLOCK_HEAD = 8             /* length of an array before its bytes, UInt64 */
};

/* The points of the file: a node once for each part that has it. */
struct points {
    int n;
    int *number;                /* (n_parts x n_nodes), -1 where a part does not have the node */
    int *node, *element, *slot; /* (n): where a point's values come from */
};

static void points_release(struct points *points)
{
    free(points->number);
    free(points->node);
    free(points->element);
    free(points->slot);
}

static enum wb_status points_init(struct points *points, const struct wb_solid_mesh *mesh)
{
    const size_t most = (size_t)mesh->n_parts * (size_t)mesh->n_nodes;
    *points = (struct points){0};
    points->number = malloc(most * sizeof *points->number);
    points->node = malloc(most * sizeof *points->node);
    points->element = malloc(most * sizeof *points->element);
    points->slot = malloc(most * sizeof *points->slot);
    if (!points->number || !points->node || !points->element || !points->slot) {
        points_release(points);
        return wb_fail(WB_ERR_MEMORY, "no memory for %zu points of a VTK file", most);
    }
    for (size_t i = 0; i < most; i++)
        points->number[i] = -1;
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int k = 0; k < CELL_NODES; k++) {
            int *number = &points->number[mesh->part[e] * mesh->n_nodes + mesh->element[e][k]];
            if (*number >= 0)
                continue;
            *number = points->n++;
            points->node[*number] = mesh->element[e][k];
            points->element[*number] = e;
            points->slot[*number] = k;
        }
    }
    return WB_OK;
}

static enum wb_status check_fields(const struct wb_solid_mesh *mesh,
                                   const struct wb_wire3d_fields *fields)
{
    bool finite = true;
    for (int i = 0; i < mesh->n_nodes; i++) {
        for (int k = 0; k < 3; k++)
            finite = finite && isfinite(fields->position[i][k]) && isfinite(mesh->node[i][k]);
    }
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int a = 0; a < CELL_NODES; a++) {
            for (int k = 0; k < 6; k++)
                finite = finite && isfinite(fields->stress[e][a][k]);
            finite = finite && isfinite(fields->plastic[e][a]);
        }
    }
    return finite ? WB_OK : wb_fail(WB_ERR_DATA, "a field has values that are not finite");
}

/* Bytes of each array, in the order in which the head and the data have them. */
struct sizes {
    uint64_t displacement, stress, von_mises, plastic, part, points, connectivity, offsets, types;
};

static struct sizes sizes_of(const struct wb_solid_mesh *mesh, const struct points *points)
{
    const uint64_t n = (uint64_t)points->n, cells = (uint64_t)mesh->n_elements;
    const struct sizes sizes = {
        .displacement = 3 * 8 * n,
        .stress = 6 * 8 * n,
        .von_mises = 8 * n,
        .plastic = 8 * n,
        .part = 4 * cells,
        .points = 3 * 8 * n,
        .connectivity = 4 * CELL_NODES * cells,
        .offsets = 4 * cells,
        .types = cells,
    };
    return sizes;
}

static void put_head(struct wb_vtk_file *w, const struct wb_solid_mesh *mesh,
                     const struct points *points, const struct sizes *sizes)
{
    const char *vector = " NumberOfComponents=\"3\"";
    wb_vtk_file_begin(w);
    wb_text_append(&w->text,
                   "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n"
                   "      <PointData>\n",
                   points->n, mesh->n_elements);
    wb_vtk_file_declare(w, "Float64", "displacement_mm", sizes->displacement, vector);
    wb_vtk_file_declare(w, "Float64", "stress_MPa", sizes->stress,
                        " NumberOfComponents=\"6\" ComponentName0=\"xx\" ComponentName1=\"yy\" "
                        "ComponentName2=\"zz\" ComponentName3=\"xy\" ComponentName4=\"yz\" "
                        "ComponentName5=\"xz\"");
    wb_vtk_file_declare(w, "Float64", "von_mises_MPa", sizes->von_mises, "");
    wb_vtk_file_declare(w, "Float64", "plastic_strain", sizes->plastic, "");
    wb_text_append(&w->text, "      </PointData>\n      <CellData>\n");
    wb_vtk_file_declare(w, "Int32", "part", sizes->part, "");
    wb_text_append(&w->text, "      </CellData>\n      <Points>\n");
    wb_vtk_file_declare(w, "Float64", "position_mm", sizes->points, vector);
    wb_text_append(&w->text, "      </Points>\n      <Cells>\n");
    wb_vtk_file_declare(w, "Int32", "connectivity", sizes->connectivity, "");
    wb_vtk_file_declare(w, "Int32", "offsets", sizes->offsets, "");
    wb_vtk_file_declare(w, "UInt8", "types", sizes->types, "");
    wb_vtk_file_end_head(w);
}

static double von_mises(const double s[6])
{
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

static void put_point_data(struct wb_vtk_file *w, const struct wb_solid_mesh *mesh,
                           const struct wb_wire3d_fields *fields, const struct points *points,
                           const struct sizes *sizes)
{
    wb_vtk_file_put_size(w, sizes->displacement);
    for (int i = 0; i < points->n; i++) {
        const int node = points->node[i];
        for (int k = 0; k < 3; k++)
            wb_vtk_file_put_double(w, (fields->position[node][k] - mesh->node[node][k]) / WB_MM);
    }
    wb_vtk_file_put_size(w, sizes->stress);
    for (int i = 0; i < points->n; i++) {
        for (int k = 0; k < 6; k++)
            wb_vtk_file_put_double(w,
                                   fields->stress[points->element[i]][points->slot[i]][k] / WB_MPA);
    }
    wb_vtk_file_put_size(w, sizes->von_mises);
    for (int i = 0; i < points->n; i++)
        wb_vtk_file_put_double(w, von_mises(fields->stress[points->element[i]][points->slot[i]]) /
                                      WB_MPA);
    wb_vtk_file_put_size(w, sizes->plastic);
    for (int i = 0; i < points->n; i++)
        wb_vtk_file_put_double(w, fields->plastic[points->element[i]][points->slot[i]]);
}

static void put_grid(struct wb_vtk_file *w, const struct wb_solid_mesh *mesh,
                     const struct points *points, const struct sizes *sizes)
{
    wb_vtk_file_put_size(w, sizes->part);
    for (int e = 0; e < mesh->n_elements; e++)
        wb_vtk_file_put_integer(w, (uint64_t)mesh->part[e], 4);
    wb_vtk_file_put_size(w, sizes->points);
    for (int i = 0; i < points->n; i++) {
        for (int k = 0; k < 3; k++)
            wb_vtk_file_put_double(w, mesh->node[points->node[i]][k] / WB_MM);
    }
    wb_vtk_file_put_size(w, sizes->connectivity);
    for (int e = 0; e < mesh->n_elements; e++) {
        const int *number = points->number + mesh->part[e] * mesh->n_nodes;
        for (int k = 0; k < CELL_NODES; k++)
            wb_vtk_file_put_integer(w, (uint64_t)number[mesh->element[e][k]], 4);
    }
    wb_vtk_file_put_size(w, sizes->offsets);
    for (int e = 0; e < mesh->n_elements; e++)
        wb_vtk_file_put_integer(w, (uint64_t)(e + 1) * CELL_NODES, 4);
    wb_vtk_file_put_size(w, sizes->types);
    for (int e = 0; e < mesh->n_elements; e++)
        wb_vtk_file_put_integer(w, QUADRATIC_HEXAHEDRON, 1);
}

enum wb_status wb_vtk_write(const char *path, const struct wb_solid_mesh *mesh,
                            const struct wb_wire3d_fields *fields)
{
    struct wb_vtk_file file = {{0}, 0};
    struct points points;
    WB_TRY(check_fields(mesh, fields));
    WB_TRY(points_init(&points, mesh));

    const struct sizes sizes = sizes_of(mesh, &points);
    put_head(&file, mesh, &points, &sizes);
    put_point_data(&file, mesh, fields, &points, &sizes);
    put_grid(&file, mesh, &points, &sizes);
    points_release(&points);
    return wb_vtk_file_write(&file, path);
}

enum wb_status wb_vtk_add(struct wb_vtk_file_series *series, double time,
                          const struct wb_solid_mesh *mesh, const struct wb_wire3d_fields *fields)
{
    char path[WB_PATH];
    WB_TRY(wb_vtk_file_series_path(series, time, path));
    WB_TRY(wb_vtk_write(path, mesh, fields));
    return wb_vtk_file_series_count(series, time);
}
