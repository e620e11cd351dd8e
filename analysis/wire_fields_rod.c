/* Fields of the 1D wire: wb_wire_fields_rod() of analysis/wire_fields.h. */
#include <math.h>
#include <stdlib.h>

#include "analysis/wire_fields.h"

#define WB_LOG_DOMAIN "fields"

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
    struct wb_wire1d_fibre *fibres;
    struct wb_field *field;
    int n;
    WB_TRY(wb_wire1d_section(rod, s, &fibres, &n));
    const enum wb_status status = wb_fields_add(fields, state, s, n, &field);
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

/* Whether no fibre of the same ring and side of the axis is nearer to the plane z = 0, or as near
 * from above. */
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

/* The fibres next to the plane z = 0 of a slice, as rectangles; every slice has as many. */
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
        struct wb_wire1d_fibre *fibres;
        int n;
        WB_TRY(wb_wire1d_section(rod, 0.5 * (slice.begin + slice.end), &fibres, &n));
        enum wb_status status = WB_OK;
        if (i == 0) {
            for (int f = 0; f < n; f++)
                faces += is_next_to_plane(fibres, n, f);
            status = wb_fields_add(fields, state, (double)NAN, n_slices * faces, &field);
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
        return wb_fail(WB_ERR_ARGUMENT, "%d slices of a wire", n_slices);
    WB_TRY(add_rod_slices(fields, model, state, rod, n_slices));
    for (int i = 0; i < model->n_sections; i++)
        WB_TRY(add_rod_section(fields, state, rod, model->section[i]));
    return WB_OK;
}
