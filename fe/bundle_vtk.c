#include "fe/bundle_vtk.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/number.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    HEXAHEDRON = 12, /* VTK's numbers */
    QUAD = 9,
    BLOCK_HEAD = 8 /* length of an array before its bytes, UInt64 */
};

/* The XML head tells where in the bytes behind it each array begins. */
struct writer {
    struct wb_text text;
    uint64_t offset;
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

/* Least byte first on any machine. */
static void put_integer(struct writer *w, uint64_t value, int n_bytes)
{
    unsigned char bytes[8];
    for (int k = 0; k < n_bytes; k++)
        bytes[k] = (unsigned char)(value >> (8 * k));
    wb_text_append_bytes(&w->text, bytes, (size_t)n_bytes);
}

static void put_float(struct writer *w, double value)
{
    const float number = (float)value;
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    put_integer(w, bits, 4);
}

static void put_double(struct writer *w, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_integer(w, bits, 8);
}

static void declare(struct writer *w, const char *type, const char *name, uint64_t size,
                    const char *more)
{
    wb_text_append(&w->text,
                   "        <DataArray type=\"%s\" Name=\"%s\"%s format=\"appended\" "
                   "offset=\"%llu\"/>\n",
                   type, name, more, (unsigned long long)w->offset);
    w->offset += BLOCK_HEAD + size;
}

static void put_head(struct writer *w, const struct wb_bundle_fields *f, const struct sizes *s)
{
    static const char vector[] = " NumberOfComponents=\"3\"";

    wb_text_append(&w->text, "<?xml version=\"1.0\"?>\n"
                             "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                             "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                             "  <UnstructuredGrid>\n"
                             "    <FieldData>\n");
    declare(w, "Float64", "deflection_mm", s->deflection, " NumberOfTuples=\"1\"");
    wb_text_append(&w->text,
                   "    </FieldData>\n"
                   "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n"
                   "      <PointData>\n",
                   f->n_points, f->n_hexahedra + f->n_quads);
    declare(w, "Float32", "displacement_mm", s->displacement, vector);
    declare(w, "Float32", "von_mises_MPa", s->von_mises, "");
    declare(w, "Float32", "plastic_strain", s->plastic, "");
    wb_text_append(&w->text, "      </PointData>\n      <CellData>\n");
    declare(w, "Int32", "wire", s->wire, "");
    wb_text_append(&w->text, "      </CellData>\n      <Points>\n");
    declare(w, "Float32", "position_mm", s->points, vector);
    wb_text_append(&w->text, "      </Points>\n      <Cells>\n");
    declare(w, "Int32", "connectivity", s->connectivity, "");
    declare(w, "Int32", "offsets", s->offsets, "");
    declare(w, "UInt8", "types", s->types, "");
    wb_text_append(&w->text, "      </Cells>\n"
                             "    </Piece>\n"
                             "  </UnstructuredGrid>\n"
                             "  <AppendedData encoding=\"raw\">\n"
                             "_");
}

static void put_point_data(struct writer *w, const struct wb_bundle_fields *f,
                           const struct sizes *s)
{
    put_integer(w, s->displacement, BLOCK_HEAD);
    for (int i = 0; i < f->n_points; i++)
        for (int k = 0; k < 3; k++)
            put_float(w, (f->position[i][k] - f->reference[i][k]) / WB_MM);
    put_integer(w, s->von_mises, BLOCK_HEAD);
    for (int i = 0; i < f->n_points; i++)
        put_float(w, f->von_mises[i] / WB_MPA);
    put_integer(w, s->plastic, BLOCK_HEAD);
    for (int i = 0; i < f->n_points; i++)
        put_float(w, f->plastic[i]);
}

static void put_cells(struct writer *w, const struct wb_bundle_fields *f, const struct sizes *s)
{
    const int cells = f->n_hexahedra + f->n_quads;
    uint64_t end = 0;

    put_integer(w, s->connectivity, BLOCK_HEAD);
    for (int e = 0; e < f->n_hexahedra; e++)
        for (int k = 0; k < 8; k++)
            put_integer(w, (uint64_t)f->hexahedron[e][k], 4);
    for (int e = 0; e < f->n_quads; e++)
        for (int k = 0; k < 4; k++)
            put_integer(w, (uint64_t)f->quad[e][k], 4);
    put_integer(w, s->offsets, BLOCK_HEAD);
    for (int e = 0; e < cells; e++) {
        end += e < f->n_hexahedra ? 8 : 4;
        put_integer(w, end, 4);
    }
    put_integer(w, s->types, BLOCK_HEAD);
    for (int e = 0; e < cells; e++)
        put_integer(w, e < f->n_hexahedra ? HEXAHEDRON : QUAD, 1);
}

static void put_grid(struct writer *w, const struct wb_bundle_fields *f, const struct sizes *s)
{
    put_integer(w, s->wire, BLOCK_HEAD);
    for (int e = 0; e < f->n_hexahedra + f->n_quads; e++) {
        const int body = f->body[e];
        put_integer(w, f->bodies[body].is_tape ? 0 : (uint64_t)body + 1, 4);
    }
    put_integer(w, s->points, BLOCK_HEAD);
    for (int i = 0; i < f->n_points; i++)
        for (int k = 0; k < 3; k++)
            put_float(w, f->reference[i][k] / WB_MM);
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

static enum wb_status write_text(const char *path, struct wb_text *text)
{
    const enum wb_status status = text->failed ? wb_fail(WB_ERR_MEMORY, "no memory for %s", path)
                                               : wb_file_write(path, text->bytes, text->length);
    wb_text_release(text);
    return status;
}

enum wb_status wb_bundle_vtk_write(const char *path, const struct wb_bundle_fields *fields,
                                   double deflection)
{
    const struct sizes sizes = sizes_of(fields);
    struct writer writer = {{0}, 0};

    WB_TRY(check_fields(fields));
    put_head(&writer, fields, &sizes);
    put_integer(&writer, sizes.deflection, BLOCK_HEAD);
    put_double(&writer, deflection / WB_MM);
    put_point_data(&writer, fields, &sizes);
    put_grid(&writer, fields, &sizes);
    wb_text_append(&writer.text, "\n  </AppendedData>\n</VTKFile>\n");
    return write_text(path, &writer.text);
}

/* --- series --- */

enum wb_status wb_bundle_vtk_init(struct wb_bundle_vtk *series, const char *folder,
                                  const char *name)
{
    if (name[0] == '\0' || strlen(name) >= WB_BUNDLE_VTK_NAME || strchr(name, '/'))
        return wb_fail(WB_ERR_ARGUMENT, "\"%s\" cannot be the name of VTK files", name);
    if (strlen(folder) >= WB_PATH)
        return wb_fail(WB_ERR_ARGUMENT, "the path of the folder for VTK files is too long");
    *series = (struct wb_bundle_vtk){0};
    strcpy(series->folder, folder);
    strcpy(series->name, name);
    return WB_OK;
}

void wb_bundle_vtk_release(struct wb_bundle_vtk *series)
{
    wb_text_release(&series->states);
    memset(series, 0, sizeof *series);
}

/* The file of a state, and its path; the .pvd file for -1. */
static enum wb_status name_file(const struct wb_bundle_vtk *series, int state,
                                char file[WB_BUNDLE_VTK_NAME + 24], char path[WB_PATH])
{
    if (state < 0)
        snprintf(file, WB_BUNDLE_VTK_NAME + 24, "%s.pvd", series->name);
    else
        snprintf(file, WB_BUNDLE_VTK_NAME + 24, "%s-%04d.vtu", series->name, state);
    return wb_file_join(path, series->folder, file);
}

/* The .pvd file with the states so far. */
static enum wb_status write_series(const struct wb_bundle_vtk *series)
{
    char file[WB_BUNDLE_VTK_NAME + 24], path[WB_PATH];
    struct wb_text text = {0};

    WB_TRY(name_file(series, -1, file, path));
    wb_text_append(&text, "<?xml version=\"1.0\"?>\n"
                          "<VTKFile type=\"Collection\" version=\"1.0\" "
                          "byte_order=\"LittleEndian\">\n"
                          "  <Collection>\n");
    wb_text_append_bytes(&text, series->states.bytes, series->states.length);
    wb_text_append(&text, "  </Collection>\n</VTKFile>\n");
    return write_text(path, &text);
}

enum wb_status wb_bundle_vtk_add(struct wb_bundle_vtk *series, double time, double deflection,
                                 const struct wb_bundle_fields *fields)
{
    char file[WB_BUNDLE_VTK_NAME + 24], path[WB_PATH], number[WB_NUMBER_TEXT];

    if (!isfinite(time) || !isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "a state of a VTK series has no finite time or deflection");
    WB_TRY(name_file(series, series->n, file, path));
    WB_TRY(wb_bundle_vtk_write(path, fields, deflection));

    wb_text_append(&series->states, "    <DataSet timestep=\"%s\" part=\"0\" file=\"",
                   wb_number_format(time, number));
    wb_text_append_escaped(&series->states, file);
    wb_text_append(&series->states, "\"/>\n");
    if (series->states.failed)
        return wb_fail(WB_ERR_MEMORY, "no memory for the VTK series %s", series->name);
    series->n++;
    return write_series(series);
}

enum wb_status wb_bundle_vtk_restart(struct wb_bundle_vtk *series)
{
    char file[WB_BUNDLE_VTK_NAME + 24], path[WB_PATH];

    for (int i = series->n - 1; i >= -1 && series->n > 0; i--) {
        WB_TRY(name_file(series, i, file, path));
        if (unlink(path) != 0 && errno != ENOENT)
            return wb_fail(WB_ERR_IO, "cannot remove '%s': %s", path, strerror(errno));
    }
    wb_text_release(&series->states);
    series->n = 0;
    return WB_OK;
}
