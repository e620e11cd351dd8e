#include "fe/output/bundle_vtk.h"

#include <math.h>

#include "base/units.h"
#include "fe/output/bundle_vtk_private.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    HEXAHEDRON = 12, /* VTK cell types */
    QUAD = 9
};

struct state {
    const struct wb_bundle_fields *fields;
    double deflection;
};

/* --- values of the arrays in the file, by index --- */

static const struct wb_bundle_fields *fields_of(const void *state)
{
    return ((const struct state *)state)->fields;
}

static double deflection(const void *state, size_t i)
{
    (void)i;
    return ((const struct state *)state)->deflection / WB_MM;
}

static double displacement(const void *state, size_t i)
{
    const struct wb_bundle_fields *const f = fields_of(state);
    return (f->position[i / 3][i % 3] - f->reference[i / 3][i % 3]) / WB_MM;
}

static double von_mises(const void *state, size_t i)
{
    return fields_of(state)->von_mises[i] / WB_MPA;
}

static double plastic(const void *state, size_t i)
{
    return fields_of(state)->plastic[i];
}

static double wire(const void *state, size_t i)
{
    const struct wb_bundle_fields *const f = fields_of(state);
    return f->bodies[f->body[i]].is_tape ? 0.0 : f->body[i] + 1.0;
}

static double position(const void *state, size_t i)
{
    return fields_of(state)->reference[i / 3][i % 3] / WB_MM;
}

static double connectivity(const void *state, size_t i)
{
    const struct wb_bundle_fields *const f = fields_of(state);
    const size_t hexahedra = 8 * (size_t)f->n_hexahedra, k = i - hexahedra;
    return i < hexahedra ? f->hexahedron[i / 8][i % 8] : f->quad[k / 4][k % 4];
}

/* VTK's `offsets`: where the entries of cell i end in `connectivity`. */
static double offset(const void *state, size_t i)
{
    const size_t hexahedra = (size_t)fields_of(state)->n_hexahedra;
    return (double)(i < hexahedra ? 8 * (i + 1) : 8 * hexahedra + 4 * (i + 1 - hexahedra));
}

static double type(const void *state, size_t i)
{
    return i < (size_t)fields_of(state)->n_hexahedra ? HEXAHEDRON : QUAD;
}

enum wb_status wb_bundle_vtk_write(const char *path, const struct wb_bundle_fields *fields,
                                   double at_deflection)
{
    static const char vector[] = " NumberOfComponents=\"3\"";
    const size_t points = (size_t)fields->n_points;
    const size_t hexahedra = (size_t)fields->n_hexahedra, quads = (size_t)fields->n_quads;
    const size_t cells = hexahedra + quads;
    const struct wb_vtk_file_array arrays[] = {
        {WB_VTK_FILE_STATE, WB_VTK_FILE_FLOAT64, "deflection_mm", " NumberOfTuples=\"1\"", 1,
         deflection},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT32, "displacement_mm", vector, 3 * points,
         displacement},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT32, "von_mises_MPa", NULL, points, von_mises},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT32, "plastic_strain", NULL, points, plastic},
        {WB_VTK_FILE_CELLS, WB_VTK_FILE_INT32, "wire", NULL, cells, wire},
        {WB_VTK_FILE_POSITIONS, WB_VTK_FILE_FLOAT32, "position_mm", vector, 3 * points, position},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_INT32, "connectivity", NULL, 8 * hexahedra + 4 * quads,
         connectivity},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_INT32, "offsets", NULL, cells, offset},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_UINT8, "types", NULL, cells, type},
    };
    const struct state state = {fields, at_deflection};

    return wb_vtk_file_write(path, fields->n_points, (int)cells, arrays,
                             sizeof arrays / sizeof arrays[0], &state);
}

enum wb_status wb_bundle_vtk_add(struct wb_vtk_file_series *series, double time, double deflection,
                                 const struct wb_bundle_fields *fields)
{
    char path[WB_PATH];

    if (!isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "VTK series: the deflection of a state is not finite");
    WB_TRY(wb_vtk_file_series_path(series, time, path));
    WB_TRY(wb_bundle_vtk_write(path, fields, deflection));
    return wb_vtk_file_series_count(series, time);
}
