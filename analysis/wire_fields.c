#include "analysis/wire_fields.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "fields"

struct solid {
    const struct wb_solid_mesh *mesh;
    const struct wb_wire3d_fields *fields;
    double (*tangent)[3]; /* (n_axis), along the deformed wire at the axis' nodes */
};

/* Slope of the quadratic through three nodes at t = 0, 1/2, 1. */
static void add_slope(const struct solid *solid, int first, double t, double tangent[3])
{
    const double slope[3] = {4.0 * t - 3.0, 4.0 - 8.0 * t, 4.0 * t - 1.0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            tangent[i] += slope[k] * solid->fields->position[solid->mesh->axis[first + k]][i];
}

/* Between two slices the mean of both slopes. */
static void find_tangents(struct solid *solid)
{
    const int n = solid->mesh->n_axis;
    for (int a = 0; a < n; a++) {
        double *const tangent = solid->tangent[a];
        memset(tangent, 0, sizeof solid->tangent[a]);
        if (a % 2 == 1) {
            add_slope(solid, a - 1, 0.5, tangent);
        } else {
            if (a > 0)
                add_slope(solid, a - 2, 1.0, tangent);
            if (a < n - 1)
                add_slope(solid, a, 0.0, tangent);
        }
    }
}

/* Unit vector along the deformed wire at x of the straight one: linear between the axis' nodes,
 * which are equally spaced. */
static void direction_at(const struct solid *solid, double x, double direction[3])
{
    const struct wb_solid_mesh *const mesh = solid->mesh;
    const double length = mesh->node[mesh->axis[mesh->n_axis - 1]][0];
    const double along = x / length * (mesh->n_axis - 1);
    const int a = (int)fmin(fmax(floor(along), 0.0), mesh->n_axis - 2);
    const double t = along - a;
    double size = 0.0;
    for (int i = 0; i < 3; i++) {
        direction[i] = (1.0 - t) * solid->tangent[a][i] + t * solid->tangent[a + 1][i];
        size += direction[i] * direction[i];
    }
    for (int i = 0; i < 3; i++)
        direction[i] /= sqrt(size);
}

/* s: xx, yy, zz, xy, yz, zx. */
static double normal_stress(const double s[6], const double n[3])
{
    return n[0] * n[0] * s[0] + n[1] * n[1] * s[1] + n[2] * n[2] * s[2] +
           2.0 * (n[0] * n[1] * s[3] + n[1] * n[2] * s[4] + n[2] * n[0] * s[5]);
}

static double von_mises(const double s[6])
{
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

static int place_in_element(const struct wb_solid_mesh *mesh, int element, int node)
{
    for (int k = 0; k < WB_SOLID_MESH_NODES; k++)
        if (mesh->element[element][k] == node)
            return k;
    return -1;
}

static enum wb_status take_face(const struct solid *solid, const struct wb_solid_face *from,
                                struct wb_field_face *face)
{
    const struct wb_solid_mesh *const mesh = solid->mesh;
    const int e = from->element;
    face->part = mesh->part[e];
    for (int k = 0; k < WB_SOLID_MESH_FACE; k++) {
        const int node = from->node[k];
        const int place = place_in_element(mesh, e, node);
        struct wb_field_node *const to = &face->node[k];
        double direction[3];
        if (place < 0)
            return wb_fail(WB_ERR_ARGUMENT, "node %d is not one of element %d", node, e);
        memcpy(to->reference, mesh->node[node], sizeof to->reference);
        memcpy(to->position, solid->fields->position[node], sizeof to->position);
        direction_at(solid, to->reference[0], direction);
        to->axial = normal_stress(solid->fields->stress[e][place], direction);
        to->von_mises = von_mises(solid->fields->stress[e][place]);
        /* Averages of extrapolations may undershoot zero. */
        to->plastic = fmax(0.0, solid->fields->plastic[e][place]);
    }
    return WB_OK;
}

static bool is_kept(const struct wb_fields *fields, const char *state, double x)
{
    const struct wb_field *const found = wb_fields_find(fields, state, x);
    return found && fabs(found->x - x) <= 1e-9;
}

static enum wb_status add_faces(struct wb_fields *fields, const struct solid *solid,
                                const char *state, double x, const struct wb_solid_face *faces,
                                int n)
{
    struct wb_field *field;
    WB_TRY(wb_fields_add(fields, state, x, n, &field));
    for (int f = 0; f < n; f++)
        WB_TRY(take_face(solid, &faces[f], &field->faces[f]));
    return WB_OK;
}

static enum wb_status add_solid_section(struct wb_fields *fields, const struct solid *solid,
                                        const char *state, double x)
{
    struct wb_solid_face *faces;
    int n;
    WB_TRY(wb_solid_mesh_section(solid->mesh, x, &faces, &n));
    /* Where the mesh has a section. */
    const double at = n > 0 ? solid->mesh->node[faces[0].node[0]][0] : x;
    enum wb_status status = WB_OK;
    if (!is_kept(fields, state, at))
        status = add_faces(fields, solid, state, at, faces, n);
    free(faces);
    return status;
}

static enum wb_status add_solid(struct wb_fields *fields, const struct wb_wire_model *model,
                                const char *state, struct solid *solid)
{
    struct wb_solid_face *faces;
    int n;
    find_tangents(solid);
    WB_TRY(wb_solid_mesh_longitudinal(solid->mesh, &faces, &n));
    const enum wb_status status = add_faces(fields, solid, state, (double)NAN, faces, n);
    free(faces);
    WB_TRY(status);
    for (int i = 0; i < model->n_sections; i++)
        WB_TRY(add_solid_section(fields, solid, state, model->section[i]));
    return WB_OK;
}

enum wb_status wb_wire_fields_solid(struct wb_fields *fields, const struct wb_wire_model *model,
                                    const char *state, const struct wb_solid_mesh *mesh,
                                    const struct wb_wire3d_fields *solid)
{
    if (mesh->n_axis < 3)
        return wb_fail(WB_ERR_ARGUMENT, "the mesh is not that of a wire");
    struct solid s = {.mesh = mesh, .fields = solid};
    s.tangent = calloc((size_t)mesh->n_axis, sizeof *s.tangent);
    if (!s.tangent)
        return wb_fail(WB_ERR_MEMORY, "no memory for fields");
    const enum wb_status status = add_solid(fields, model, state, &s);
    free(s.tangent);
    return status;
}
