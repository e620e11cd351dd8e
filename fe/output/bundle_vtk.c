#include "fe/output/bundle_vtk.h"

#include <math.h>
#include <stdint.h>

#include "base/units.h"
#include "fe/output/bundle_vtk_private.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    HEXAHEDRON = 12, /* VTK's numbers */
    QUAD = 9
};

/* Bytes of each array, in the order in which head and data have them. */
struct sizes {
    uint64_t deflection, displacement, von_mises, plastic, wire;
    uint64_t points, connectivity, offsets, types;
};

static struct sizes sizes_of(const struct wb_bundle_fields *f)
{
    const uint64_t points = (uint64_t)f->n_points;
    const uint64_t hexahedra = (uint64_t)f->n_hexahedra, quads = (uint64_t)f->n_quads;
    const uint64_t cells = hexahedra + quads;

    return (struct sizes){
        .deflection = 8,
        .displacement = 12 * points,
        .von_mises = 4 * points,
        .plastic = 4 * points,
        .wire = 4 * cells,
        .points = 12 * points,
        .connectivity = 4 * (8 * hexahedra + 4 * quads),
        .offsets = 4 * cells,
        .types = cells,
    };
}

static void put_head(struct wb_vtk_file *w, const struct wb_bundle_fields *f, const struct sizes *s)
{
    static const char vector[] = " NumberOfComponents=\"3\"";

    wb_vtk_file_begin(w);
    wb_text_append(&w->text, "    <FieldData>\n");
    wb_vtk_file_declare(w, "Float64", "deflection_mm", s->deflection, " NumberOfTuples=\"1\"");
    wb_text_append(&w->text,
                   "    </FieldData>\n"
                   "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n"
                   "      <PointData>\n",
                   f->n_points, f->n_hexahedra + f->n_quads);
    wb_vtk_file_declare(w, "Float32", "displacement_mm", s->displacement, vector);
    wb_vtk_file_declare(w, "Float32", "von_mises_MPa", s->von_mises, "");
    wb_vtk_file_declare(w, "Float32", "plastic_strain", s->plastic, "");
    wb_text_append(&w->text, "      </PointData>\n      <CellData>\n");
    wb_vtk_file_declare(w, "Int32", "wire", s->wire, "");
    wb_text_append(&w->text, "      </CellData>\n      <Points>\n");
    wb_vtk_file_declare(w, "Float32", "position_mm", s->points, vector);
    wb_text_append(&w->text, "      </Points>\n      <Cells>\n");
    wb_vtk_file_declare(w, "Int32", "connectivity", s->connectivity, "");
    wb_vtk_file_declare(w, "Int32", "offsets", s->offsets, "");
    wb_vtk_file_declare(w, "UInt8", "types", s->types, "");
    wb_vtk_file_end_head(w);
}

static void put_point_data(struct wb_vtk_file *w, const struct wb_bundle_fields *f,
                           const struct sizes *s)
{
    wb_vtk_file_put_size(w, s->displacement);
    for (int i = 0; i < f->n_points; i++)
        for (int k = 0; k < 3; k++)
            wb_vtk_file_put_float(w, (f->position[i][k] - f->reference[i][k]) / WB_MM);
    wb_vtk_file_put_size(w, s->von_mises);
    for (int i = 0; i < f->n_points; i++)
        wb_vtk_file_put_float(w, f->von_mises[i] / WB_MPA);
    wb_vtk_file_put_size(w, s->plastic);
    for (int i = 0; i < f->n_points; i++)
        wb_vtk_file_put_float(w, f->plastic[i]);
}

static void put_cells(struct wb_vtk_file *w, const struct wb_bundle_fields *f,
                      const struct sizes *s)
{
    const int cells = f->n_hexahedra + f->n_quads;
    uint64_t end = 0;

    wb_vtk_file_put_size(w, s->connectivity);
    for (int e = 0; e < f->n_hexahedra; e++)
        for (int k = 0; k < 8; k++)
            wb_vtk_file_put_integer(w, (uint64_t)f->hexahedron[e][k], 4);
    for (int e = 0; e < f->n_quads; e++)
        for (int k = 0; k < 4; k++)
            wb_vtk_file_put_integer(w, (uint64_t)f->quad[e][k], 4);
    wb_vtk_file_put_size(w, s->offsets);
    for (int e = 0; e < cells; e++) {
        end += e < f->n_hexahedra ? 8 : 4;
        wb_vtk_file_put_integer(w, end, 4);
    }
    wb_vtk_file_put_size(w, s->types);
    for (int e = 0; e < cells; e++)
        wb_vtk_file_put_integer(w, e < f->n_hexahedra ? HEXAHEDRON : QUAD, 1);
}

static void put_grid(struct wb_vtk_file *w, const struct wb_bundle_fields *f, const struct sizes *s)
{
    wb_vtk_file_put_size(w, s->wire);
    for (int e = 0; e < f->n_hexahedra + f->n_quads; e++) {
        const int body = f->body[e];
        wb_vtk_file_put_integer(w, f->bodies[body].is_tape ? 0 : (uint64_t)body + 1, 4);
    }
    wb_vtk_file_put_size(w, s->points);
    for (int i = 0; i < f->n_points; i++)
        for (int k = 0; k < 3; k++)
            wb_vtk_file_put_float(w, f->reference[i][k] / WB_MM);
    put_cells(w, f, s);
}

static enum wb_status check_fields(const struct wb_bundle_fields *f)
{
    bool finite = true;

    for (int i = 0; i < f->n_points; i++) {
        for (int k = 0; k < 3; k++)
            finite = finite && isfinite(f->position[i][k]);
        finite = finite && isfinite(f->von_mises[i]) && isfinite(f->plastic[i]);
    }
    return finite ? WB_OK : wb_fail(WB_ERR_DATA, "a field has values that are not finite");
}

enum wb_status wb_bundle_vtk_write(const char *path, const struct wb_bundle_fields *fields,
                                   double deflection)
{
    const struct sizes sizes = sizes_of(fields);
    struct wb_vtk_file file = {{0}, 0};

    WB_TRY(check_fields(fields));
    put_head(&file, fields, &sizes);
    wb_vtk_file_put_size(&file, sizes.deflection);
    wb_vtk_file_put_double(&file, deflection / WB_MM);
    put_point_data(&file, fields, &sizes);
    put_grid(&file, fields, &sizes);
    return wb_vtk_file_write(&file, path);
}

enum wb_status wb_bundle_vtk_add(struct wb_vtk_file_series *series, double time, double deflection,
                                 const struct wb_bundle_fields *fields)
{
    char path[WB_PATH];

    if (!isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "a state of a VTK series has no finite deflection");
    WB_TRY(wb_vtk_file_series_path(series, time, path));
    WB_TRY(wb_bundle_vtk_write(path, fields, deflection));
    return wb_vtk_file_series_count(series, time);
}
