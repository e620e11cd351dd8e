#include "fe/vtk.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/units.h"

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

/* Writing: the XML head tells where in the bytes behind it each array begins. */
struct writer {
    struct wb_text text;
    uint64_t offset;
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

/* Integers and doubles, least byte first on any machine. */
static void put_integer(struct writer *w, uint64_t value, int n_bytes)
{
    unsigned char bytes[8];
    for (int k = 0; k < n_bytes; k++)
        bytes[k] = (unsigned char)(value >> (8 * k));
    wb_text_append_bytes(&w->text, bytes, (size_t)n_bytes);
}

static void put_double(struct writer *w, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_integer(w, bits, 8);
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

/* Declares an array; `more` are further attributes. */
static void declare(struct writer *w, const char *type, const char *name, uint64_t bytes,
                    const char *more)
{
    wb_text_append(&w->text,
                   "        <DataArray type=\"%s\" Name=\"%s\"%s format=\"appended\" "
                   "offset=\"%llu\"/>\n",
                   type, name, more, (unsigned long long)w->offset);
    w->offset += BLOCK_HEAD + bytes;
}

static void put_head(struct writer *w, const struct wb_solid_mesh *mesh,
                     const struct points *points, const struct sizes *sizes)
{
    const char *vector = " NumberOfComponents=\"3\"";
    wb_text_append(&w->text,
                   "<?xml version=\"1.0\"?>\n"
                   "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                   "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                   "  <UnstructuredGrid>\n"
                   "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n"
                   "      <PointData>\n",
                   points->n, mesh->n_elements);
    declare(w, "Float64", "displacement_mm", sizes->displacement, vector);
    declare(w, "Float64", "stress_MPa", sizes->stress,
            " NumberOfComponents=\"6\" ComponentName0=\"xx\" ComponentName1=\"yy\" "
            "ComponentName2=\"zz\" ComponentName3=\"xy\" ComponentName4=\"yz\" "
            "ComponentName5=\"xz\"");
    declare(w, "Float64", "von_mises_MPa", sizes->von_mises, "");
    declare(w, "Float64", "plastic_strain", sizes->plastic, "");
    wb_text_append(&w->text, "      </PointData>\n      <CellData>\n");
    declare(w, "Int32", "part", sizes->part, "");
    wb_text_append(&w->text, "      </CellData>\n      <Points>\n");
    declare(w, "Float64", "position_mm", sizes->points, vector);
    wb_text_append(&w->text, "      </Points>\n      <Cells>\n");
    declare(w, "Int32", "connectivity", sizes->connectivity, "");
    declare(w, "Int32", "offsets", sizes->offsets, "");
    declare(w, "UInt8", "types", sizes->types, "");
    wb_text_append(&w->text, "      </Cells>\n"
                             "    </Piece>\n"
                             "  </UnstructuredGrid>\n"
                             "  <AppendedData encoding=\"raw\">\n"
                             "_");
}

static double von_mises(const double s[6])
{
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

static void put_point_data(struct writer *w, const struct wb_solid_mesh *mesh,
                           const struct wb_wire3d_fields *fields, const struct points *points,
                           const struct sizes *sizes)
{
    put_integer(w, sizes->displacement, BLOCK_HEAD);
    for (int i = 0; i < points->n; i++) {
        const int node = points->node[i];
        for (int k = 0; k < 3; k++)
            put_double(w, (fields->position[node][k] - mesh->node[node][k]) / WB_MM);
    }
    put_integer(w, sizes->stress, BLOCK_HEAD);
    for (int i = 0; i < points->n; i++) {
        for (int k = 0; k < 6; k++)
            put_double(w, fields->stress[points->element[i]][points->slot[i]][k] / WB_MPA);
    }
    put_integer(w, sizes->von_mises, BLOCK_HEAD);
    for (int i = 0; i < points->n; i++)
        put_double(w, von_mises(fields->stress[points->element[i]][points->slot[i]]) / WB_MPA);
    put_integer(w, sizes->plastic, BLOCK_HEAD);
    for (int i = 0; i < points->n; i++)
        put_double(w, fields->plastic[points->element[i]][points->slot[i]]);
}

static void put_grid(struct writer *w, const struct wb_solid_mesh *mesh,
                     const struct points *points, const struct sizes *sizes)
{
    put_integer(w, sizes->part, BLOCK_HEAD);
    for (int e = 0; e < mesh->n_elements; e++)
        put_integer(w, (uint64_t)mesh->part[e], 4);
    put_integer(w, sizes->points, BLOCK_HEAD);
    for (int i = 0; i < points->n; i++) {
        for (int k = 0; k < 3; k++)
            put_double(w, mesh->node[points->node[i]][k] / WB_MM);
    }
    put_integer(w, sizes->connectivity, BLOCK_HEAD);
    for (int e = 0; e < mesh->n_elements; e++) {
        const int *number = points->number + mesh->part[e] * mesh->n_nodes;
        for (int k = 0; k < CELL_NODES; k++)
            put_integer(w, (uint64_t)number[mesh->element[e][k]], 4);
    }
    put_integer(w, sizes->offsets, BLOCK_HEAD);
    for (int e = 0; e < mesh->n_elements; e++)
        put_integer(w, (uint64_t)(e + 1) * CELL_NODES, 4);
    put_integer(w, sizes->types, BLOCK_HEAD);
    for (int e = 0; e < mesh->n_elements; e++)
        put_integer(w, QUADRATIC_HEXAHEDRON, 1);
}

static enum wb_status write_text(const char *path, struct wb_text *text)
{
    const enum wb_status status = text->failed ? wb_fail(WB_ERR_MEMORY, "no memory for %s", path)
                                               : wb_file_write(path, text->bytes, text->length);
    wb_text_release(text);
    return status;
}

enum wb_status wb_vtk_write(const char *path, const struct wb_solid_mesh *mesh,
                            const struct wb_wire3d_fields *fields)
{
    struct writer writer = {{0}, 0};
    struct points points;
    WB_TRY(check_fields(mesh, fields));
    WB_TRY(points_init(&points, mesh));

    const struct sizes sizes = sizes_of(mesh, &points);
    put_head(&writer, mesh, &points, &sizes);
    put_point_data(&writer, mesh, fields, &points, &sizes);
    put_grid(&writer, mesh, &points, &sizes);
    wb_text_append(&writer.text, "\n  </AppendedData>\n</VTKFile>\n");
    points_release(&points);
    return write_text(path, &writer.text);
}

enum wb_status wb_vtk_series_init(struct wb_vtk_series *series, const char *folder,
                                  const char *name)
{
    if (name[0] == '\0' || strlen(name) >= WB_VTK_NAME || strchr(name, '/'))
        return wb_fail(WB_ERR_ARGUMENT, "\"%s\" cannot be the name of VTK files", name);
    if (strlen(folder) >= WB_PATH)
        return wb_fail(WB_ERR_ARGUMENT, "the path of the folder for VTK files is too long");
    *series = (struct wb_vtk_series){0};
    strcpy(series->folder, folder);
    strcpy(series->name, name);
    return WB_OK;
}

void wb_vtk_series_release(struct wb_vtk_series *series)
{
    wb_text_release(&series->states);
    memset(series, 0, sizeof *series);
}

/* The .pvd file with the states so far. */
static enum wb_status write_series(const struct wb_vtk_series *series)
{
    char file[WB_VTK_NAME + 8], path[WB_PATH];
    struct wb_text text = {0};
    snprintf(file, sizeof file, "%s.pvd", series->name);
    WB_TRY(wb_file_join(path, series->folder, file));
    wb_text_append(&text, "<?xml version=\"1.0\"?>\n"
                          "<VTKFile type=\"Collection\" version=\"1.0\" "
                          "byte_order=\"LittleEndian\">\n"
                          "  <Collection>\n");
    wb_text_append_bytes(&text, series->states.bytes, series->states.length);
    wb_text_append(&text, "  </Collection>\n</VTKFile>\n");
    return write_text(path, &text);
}

enum wb_status wb_vtk_series_add(struct wb_vtk_series *series, double time,
                                 const struct wb_solid_mesh *mesh,
                                 const struct wb_wire3d_fields *fields)
{
    char file[WB_VTK_NAME + 24], path[WB_PATH], number[WB_NUMBER_TEXT];
    if (!isfinite(time))
        return wb_fail(WB_ERR_ARGUMENT, "a state of a VTK series has no finite time");
    snprintf(file, sizeof file, "%s-%04d.vtu", series->name, series->n);
    WB_TRY(wb_file_join(path, series->folder, file));
    WB_TRY(wb_vtk_write(path, mesh, fields));

    wb_text_append(&series->states, "    <DataSet timestep=\"%s\" part=\"0\" file=\"",
                   wb_number_format(time, number));
    wb_text_append_escaped(&series->states, file);
    wb_text_append(&series->states, "\"/>\n");
    if (series->states.failed)
        return wb_fail(WB_ERR_MEMORY, "no memory for the VTK series %s", series->name);
    series->n++;
    return write_series(series);
}
