#include "fe/output/vtk_file.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/number.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    BLOCK_HEAD = 8,                   /* bytes of the length (UInt64) before each array */
    FILE_NAME = WB_VTK_FILE_NAME + 24 /* including the number of a state */
};

/* --- one file --- */

static const struct {
    const char *name;
    int bytes;
} types[] = {
    [WB_VTK_FILE_UINT8] = {"UInt8", 1},
    [WB_VTK_FILE_INT32] = {"Int32", 4},
    [WB_VTK_FILE_FLOAT32] = {"Float32", 4},
    [WB_VTK_FILE_FLOAT64] = {"Float64", 8},
};

static const char *const sections[WB_VTK_FILE_SECTIONS] = {
    [WB_VTK_FILE_STATE] = "FieldData", [WB_VTK_FILE_POINTS] = "PointData",
    [WB_VTK_FILE_CELLS] = "CellData",  [WB_VTK_FILE_POSITIONS] = "Points",
    [WB_VTK_FILE_TOPOLOGY] = "Cells",
};

static size_t size_of(const struct wb_vtk_file_array *array)
{
    return array->count * (size_t)types[array->type].bytes;
}

/* Declares the arrays of a section; `offset` is the position of the next array. A state without
 * arrays of its own has no such section. */
static void put_section(struct wb_text *text, int section, const struct wb_vtk_file_array *arrays,
                        size_t n, size_t *offset)
{
    const char *const indent = section == WB_VTK_FILE_STATE ? "    " : "      ";
    bool any = section != WB_VTK_FILE_STATE;

    for (size_t i = 0; i < n; i++)
        any = any || (int)arrays[i].section == section;
    if (!any)
        return;
    wb_text_append(text, "%s<%s>\n", indent, sections[section]);
    for (size_t i = 0; i < n; i++) {
        if ((int)arrays[i].section != section)
            continue;
        wb_text_append(text,
                       "        <DataArray type=\"%s\" Name=\"%s\"%s format=\"appended\" "
                       "offset=\"%zu\"/>\n",
                       types[arrays[i].type].name, arrays[i].name,
                       arrays[i].more ? arrays[i].more : "", *offset);
        *offset += BLOCK_HEAD + size_of(&arrays[i]);
    }
    wb_text_append(text, "%s</%s>\n", indent, sections[section]);
}

static void put_head(struct wb_text *text, int n_points, int n_cells,
                     const struct wb_vtk_file_array *arrays, size_t n)
{
    size_t offset = 0;

    wb_text_append(text, "<?xml version=\"1.0\"?>\n"
                         "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                         "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                         "  <UnstructuredGrid>\n");
    put_section(text, WB_VTK_FILE_STATE, arrays, n, &offset);
    wb_text_append(text, "    <Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n", n_points,
                   n_cells);
    for (int section = WB_VTK_FILE_POINTS; section < WB_VTK_FILE_SECTIONS; section++)
        put_section(text, section, arrays, n, &offset);
    wb_text_append(text, "    </Piece>\n"
                         "  </UnstructuredGrid>\n"
                         "  <AppendedData encoding=\"raw\">\n"
                         "_");
}

static void put_integer(struct wb_text *text, uint64_t value, int n_bytes)
{
    unsigned char bytes[8];
    for (int k = 0; k < n_bytes; k++)
        bytes[k] = (unsigned char)(value >> (8 * k));
    wb_text_append_bytes(text, bytes, (size_t)n_bytes);
}

static void put_number(struct wb_text *text, enum wb_vtk_file_type type, double value)
{
    const float narrow = (float)value;
    uint64_t bits = 0;
    uint32_t narrow_bits;

    if (type == WB_VTK_FILE_FLOAT64) {
        memcpy(&bits, &value, sizeof bits);
    } else if (type == WB_VTK_FILE_FLOAT32) {
        memcpy(&narrow_bits, &narrow, sizeof narrow_bits);
        bits = narrow_bits;
    } else {
        bits = (uint64_t)value;
    }
    put_integer(text, bits, types[type].bytes);
}

/* Appends the array's size in bytes, then its values. False if a value is not finite. */
static bool put_array(struct wb_text *text, const struct wb_vtk_file_array *array,
                      const void *state)
{
    put_integer(text, size_of(array), BLOCK_HEAD);
    for (size_t i = 0; i < array->count; i++) {
        const double value = array->value(state, i);
        if (!isfinite(value))
            return false;
        put_number(text, array->type, value);
    }
    return true;
}

static enum wb_status write_text(const char *path, struct wb_text *text)
{
    const enum wb_status status = wb_file_write_text(path, text);
    wb_text_release(text);
    return status;
}

enum wb_status wb_vtk_file_write(const char *path, int n_points, int n_cells,
                                 const struct wb_vtk_file_array *arrays, size_t n,
                                 const void *state)
{
    struct wb_text text = {0};

    put_head(&text, n_points, n_cells, arrays, n);
    for (size_t i = 0; i < n; i++) {
        if (!put_array(&text, &arrays[i], state)) {
            wb_text_release(&text);
            return wb_fail(WB_ERR_DATA, "a field has values that are not finite");
        }
    }
    wb_text_append(&text, "\n  </AppendedData>\n</VTKFile>\n");
    return write_text(path, &text);
}

/* --- a series --- */

enum wb_status wb_vtk_file_series_init(struct wb_vtk_file_series *series, const char *folder,
                                       const char *name)
{
    if (name[0] == '\0' || strlen(name) >= WB_VTK_FILE_NAME || strchr(name, '/'))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "'%s' cannot be the name of VTK files: expected 1 to %d characters without '/'", name,
            WB_VTK_FILE_NAME - 1);
    if (strlen(folder) >= WB_PATH)
        return wb_fail(WB_ERR_ARGUMENT, "the path of the folder for VTK files is too long");
    *series = (struct wb_vtk_file_series){0};
    strcpy(series->folder, folder);
    strcpy(series->name, name);
    return WB_OK;
}

void wb_vtk_file_series_release(struct wb_vtk_file_series *series)
{
    wb_text_release(&series->states);
    memset(series, 0, sizeof *series);
}

static void name_state(const struct wb_vtk_file_series *series, int state, char file[FILE_NAME])
{
    snprintf(file, FILE_NAME, "%s-%04d.vtu", series->name, state);
}

static enum wb_status find_list(const struct wb_vtk_file_series *series, char path[WB_PATH])
{
    char file[FILE_NAME];
    snprintf(file, sizeof file, "%s.pvd", series->name);
    return wb_file_join(path, series->folder, file);
}

enum wb_status wb_vtk_file_series_path(const struct wb_vtk_file_series *series, double time,
                                       char path[WB_PATH])
{
    char file[FILE_NAME];
    if (!isfinite(time))
        return wb_fail(WB_ERR_ARGUMENT, "VTK series: the time of a state is not finite");
    name_state(series, series->n, file);
    return wb_file_join(path, series->folder, file);
}

/* Writes the .pvd file with the states so far. */
static enum wb_status write_list(const struct wb_vtk_file_series *series)
{
    char path[WB_PATH];
    struct wb_text text = {0};
    WB_TRY(find_list(series, path));
    wb_text_append(&text, "<?xml version=\"1.0\"?>\n"
                          "<VTKFile type=\"Collection\" version=\"1.0\" "
                          "byte_order=\"LittleEndian\">\n"
                          "  <Collection>\n");
    wb_text_append_bytes(&text, series->states.bytes, series->states.length);
    wb_text_append(&text, "  </Collection>\n</VTKFile>\n");
    return write_text(path, &text);
}

enum wb_status wb_vtk_file_series_count(struct wb_vtk_file_series *series, double time)
{
    char file[FILE_NAME], number[WB_NUMBER_TEXT];
    name_state(series, series->n, file);
    wb_text_append(&series->states, "    <DataSet timestep=\"%s\" part=\"0\" file=\"",
                   wb_number_format(time, number));
    wb_text_append_escaped(&series->states, file);
    wb_text_append(&series->states, "\"/>\n");
    series->n++;
    return write_list(series);
}

static enum wb_status remove_file(const char *path)
{
    if (unlink(path) != 0 && errno != ENOENT)
        return wb_fail(WB_ERR_IO, "cannot remove '%s': %s", path, strerror(errno));
    return WB_OK;
}

enum wb_status wb_vtk_file_series_restart(struct wb_vtk_file_series *series)
{
    char file[FILE_NAME], path[WB_PATH];

    for (int i = series->n - 1; i >= 0; i--) {
        name_state(series, i, file);
        WB_TRY(wb_file_join(path, series->folder, file));
        WB_TRY(remove_file(path));
    }
    if (series->n > 0) {
        WB_TRY(find_list(series, path));
        WB_TRY(remove_file(path));
    }
    wb_text_release(&series->states);
    series->n = 0;
    return WB_OK;
}
