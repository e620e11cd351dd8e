#include "analysis/dataset/wire_fields.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/material/material.h"

#define WB_LOG_DOMAIN "fields"

/* --- the 3D wire --- */

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
        to->von_mises = wb_material_von_mises(solid->fields->stress[e][place]);
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
    WB_TRY(wb_fields_add(fields, state, x, n, &field, NULL));
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
    /* The nearest section of the mesh. */
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
    s.tangent = wb_memory_new((size_t)mesh->n_axis, sizeof *s.tangent);
    const enum wb_status status = add_solid(fields, model, state, &s);
    free(s.tangent);
    return status;
}

/* --- the 1D wire --- */

/* The point (y, z) of the section at s, in the straight and in the deformed wire. */
static void place(const struct wb_wire1d *rod, double s, double y, double z,
                  struct wb_field_node *node)
{
    double axis[3], frame[3][3];
    wb_wire1d_frame(rod, s, axis, frame);
    node->reference[0] = s;
    node->reference[1] = y;
    node->reference[2] = z;
    for (int i = 0; i < 3; i++)
        node->position[i] = axis[i] + y * frame[1][i] + z * frame[2][i];
}

static void take_fibre(const struct wb_wire1d_fibre *fibre, struct wb_field_face *face)
{
    face->part = fibre->part;
    for (int k = 0; k < 8; k++) {
        face->node[k].axial = fibre->axial;
        face->node[k].von_mises =
            sqrt(fibre->axial * fibre->axial + 3.0 * fibre->shear * fibre->shear);
        face->node[k].plastic = fibre->plastic;
    }
}

/* Places of a face's 8 nodes in its own coordinates, 0 to 1. */
static const double corners[8][2] = {{0, 0},   {1, 0},   {1, 1},   {0, 1},
                                     {0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};

static enum wb_status add_rod_section(struct wb_fields *fields, const char *state,
                                      const struct wb_wire1d *rod, double s)
{
    struct wb_field *field;
    int n;
    struct wb_wire1d_fibre *const fibres = wb_wire1d_section(rod, s, &n);
    const enum wb_status status = wb_fields_add(fields, state, s, n, &field, NULL);
    for (int f = 0; status == WB_OK && f < n; f++) {
        const struct wb_wire1d_fibre *const fibre = &fibres[f];
        take_fibre(fibre, &field->faces[f]);
        for (int k = 0; k < 8; k++) {
            const double r =
                fibre->inner_radius + corners[k][0] * (fibre->outer_radius - fibre->inner_radius);
            const double angle =
                fibre->begin_angle + corners[k][1] * (fibre->end_angle - fibre->begin_angle);
            place(rod, s, r * cos(angle), r * sin(angle), &field->faces[f].node[k]);
        }
    }
    free(fibres);
    return status;
}

/* Whether the fibre is the nearest of its ring and side to the plane z = 0; of two at the same
 * distance the upper one. */
static bool is_next_to_plane(const struct wb_wire1d_fibre *fibres, int n, int f)
{
    const double same = 1e-9 * fibres[f].outer_radius;
    for (int i = 0; i < n; i++) {
        const struct wb_wire1d_fibre *const other = &fibres[i];
        if (other->part != fibres[f].part ||
            fabs(other->outer_radius - fibres[f].outer_radius) > same ||
            (other->y > 0.0) != (fibres[f].y > 0.0))
            continue;
        const double nearer = fabs(fibres[f].z) - fabs(other->z);
        if (nearer > same || (nearer > -same && other->z > fibres[f].z + same))
            return false;
    }
    return true;
}

/* The fibres next to the plane z = 0 of a slice, as rectangles; every slice has the same number. */
struct slice {
    double begin, end; /* m */
    int n_faces;
    struct wb_field_face *faces;
};

static enum wb_status take_slice(const struct wb_wire1d *rod, const struct wb_wire1d_fibre *fibres,
                                 int n, const struct slice *slice)
{
    int count = 0;
    for (int f = 0; f < n; f++) {
        if (!is_next_to_plane(fibres, n, f))
            continue;
        if (count == slice->n_faces)
            return wb_fail(WB_ERR_DATA, "sections of one wire have different fibres");
        const double side = fibres[f].y > 0.0 ? 1.0 : -1.0;
        struct wb_field_face *const face = &slice->faces[count++];
        take_fibre(&fibres[f], face);
        for (int k = 0; k < 8; k++) {
            const double r = fibres[f].inner_radius +
                             corners[k][1] * (fibres[f].outer_radius - fibres[f].inner_radius);
            place(rod, slice->begin + corners[k][0] * (slice->end - slice->begin), side * r, 0.0,
                  &face->node[k]);
        }
    }
    return WB_OK;
}

static enum wb_status add_rod_slices(struct wb_fields *fields, const struct wb_wire_model *model,
                                     const char *state, const struct wb_wire1d *rod, int n_slices)
{
    struct wb_field *field = NULL;
    int faces = 0;
    for (int i = 0; i < n_slices; i++) {
        struct slice slice = {.begin = model->length * i / n_slices,
                              .end = model->length * (i + 1) / n_slices};
        int n;
        struct wb_wire1d_fibre *const fibres =
            wb_wire1d_section(rod, 0.5 * (slice.begin + slice.end), &n);
        enum wb_status status = WB_OK;
        if (i == 0) {
            for (int f = 0; f < n; f++)
                faces += is_next_to_plane(fibres, n, f);
            status = wb_fields_add(fields, state, (double)NAN, n_slices * faces, &field, NULL);
        }
        if (status == WB_OK) {
            slice.n_faces = faces;
            slice.faces = field->faces + (size_t)i * (size_t)faces;
            status = take_slice(rod, fibres, n, &slice);
        }
        free(fibres);
        WB_TRY(status);
    }
    return WB_OK;
}

enum wb_status wb_wire_fields_rod(struct wb_fields *fields, const struct wb_wire_model *model,
                                  const char *state, const struct wb_wire1d *rod, int n_slices)
{
    if (n_slices < 1)
        return wb_fail(WB_ERR_ARGUMENT, "the wire has %d slices: expected 1 or more", n_slices);
    WB_TRY(add_rod_slices(fields, model, state, rod, n_slices));
    for (int i = 0; i < model->n_sections; i++)
        WB_TRY(add_rod_section(fields, state, rod, model->section[i]));
    return WB_OK;
}
