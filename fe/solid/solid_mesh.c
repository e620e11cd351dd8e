#include "fe/solid/solid_mesh.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "mesh"

enum {
    FACES = 6,
    MOST_NODES = 10000000 /* node and unknown numbers stay far from the range of int */
};

/* Nodes of the faces of an element, normals outward. */
static const int face_node[FACES][WB_SOLID_MESH_FACE] = {
    {0, 3, 2, 1, 11, 10, 9, 8},  {4, 5, 6, 7, 12, 13, 14, 15}, {0, 1, 5, 4, 8, 17, 12, 16},
    {1, 2, 6, 5, 9, 18, 13, 17}, {2, 3, 7, 6, 10, 19, 14, 18}, {3, 0, 4, 7, 11, 16, 15, 19},
};

/* The side at the start of a slice, running around as the side at its end (the face 1). */
static const int start_face[WB_SOLID_MESH_FACE] = {0, 1, 2, 3, 8, 9, 10, 11};

enum wb_status wb_solid_mesh_init(struct wb_solid_mesh *mesh, int n_nodes, int n_elements)
{
    if (n_nodes < 1 || n_nodes > MOST_NODES || n_elements < 1 || n_elements > MOST_NODES)
        return wb_fail(WB_ERR_ARGUMENT, "a mesh has 1 to %d nodes and elements, not %d and %d",
                       MOST_NODES, n_nodes, n_elements);

    struct wb_solid_mesh made = {
        .n_nodes = n_nodes, .n_elements = n_elements, .n_parts = 1, .n_layers = 1};
    made.node = calloc((size_t)n_nodes, sizeof *made.node);
    made.element = calloc((size_t)n_elements, sizeof *made.element);
    made.part = calloc((size_t)n_elements, sizeof *made.part);
    made.layer = calloc(2, sizeof *made.layer);
    made.link = calloc(1, sizeof *made.link);
    if (!made.node || !made.element || !made.part || !made.layer || !made.link) {
        wb_solid_mesh_release(&made);
        return wb_fail(WB_ERR_MEMORY, "no memory for a mesh of %d elements", n_elements);
    }
    made.layer[1] = n_nodes;
    *mesh = made;
    return WB_OK;
}

void wb_solid_mesh_release(struct wb_solid_mesh *mesh)
{
    free(mesh->node);
    free(mesh->element);
    free(mesh->part);
    free(mesh->layer);
    free(mesh->link);
    free(mesh->pair);
    free(mesh->clamp);
    free(mesh->tip_face);
    free(mesh->axis);
    memset(mesh, 0, sizeof *mesh);
}

static void take_face(struct wb_solid_face *face, const struct wb_solid_mesh *mesh, int e,
                      const int which[WB_SOLID_MESH_FACE])
{
    face->element = e;
    for (int k = 0; k < WB_SOLID_MESH_FACE; k++)
        face->node[k] = mesh->element[e][which[k]];
}

/* Whether a face lies on z = 0 and its element on the side z > 0. */
static bool is_on_plane(const struct wb_solid_mesh *mesh, int e, const int which[], double near)
{
    double above = 0.0;
    for (int k = 0; k < WB_SOLID_MESH_NODES; k++)
        above += mesh->node[mesh->element[e][k]][2];
    for (int k = 0; k < WB_SOLID_MESH_FACE; k++) {
        if (!(fabs(mesh->node[mesh->element[e][which[k]]][2]) <= near))
            return false;
    }
    return above > 0.0;
}

enum wb_status wb_solid_mesh_longitudinal(const struct wb_solid_mesh *mesh,
                                          struct wb_solid_face **faces, int *n)
{
    double widest = 0.0;
    for (int i = 0; i < mesh->n_nodes; i++)
        widest = fmax(widest, fabs(mesh->node[i][2]));
    const double near = 1e-9 * widest;

    int found = 0;
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int f = 0; f < FACES; f++)
            found += is_on_plane(mesh, e, face_node[f], near);
    }
    if (found == 0)
        return wb_fail(WB_ERR_ARGUMENT, "no face of the mesh lies on the plane z = 0");
    struct wb_solid_face *list = calloc((size_t)found, sizeof *list);
    if (!list)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d faces", found);

    int next = 0;
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int f = 0; f < FACES; f++) {
            if (is_on_plane(mesh, e, face_node[f], near))
                take_face(&list[next++], mesh, e, face_node[f]);
        }
    }
    *faces = list;
    *n = found;
    return WB_OK;
}

enum wb_status wb_solid_mesh_section(const struct wb_solid_mesh *mesh, double x,
                                     struct wb_solid_face **faces, int *n)
{
    if (mesh->n_axis < 3 || !isfinite(x))
        return wb_fail(WB_ERR_ARGUMENT, "no section at x = %g m: the mesh is not a wire's", x);

    /* Every other node of the axis lies in a section. */
    int section = 0;
    for (int i = 0; i < mesh->n_axis; i += 2) {
        if (fabs(mesh->node[mesh->axis[i]][0] - x) <
            fabs(mesh->node[mesh->axis[2 * section]][0] - x))
            section = i / 2;
    }
    const int in_slice = mesh->n_tip_faces;
    struct wb_solid_face *list = calloc((size_t)in_slice, sizeof *list);
    if (!list)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d faces", in_slice);

    const int first = (section > 0 ? section - 1 : 0) * in_slice;
    for (int q = 0; q < in_slice; q++)
        take_face(&list[q], mesh, first + q, section > 0 ? face_node[1] : start_face);
    *faces = list;
    *n = in_slice;
    return WB_OK;
}
