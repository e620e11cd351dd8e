#include "fe/output/vtk_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/number.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    BLOCK_HEAD = 8,                   /* length of an array before its bytes, UInt64 */
    FILE_NAME = WB_VTK_FILE_NAME + 24 /* with the number of a state */
};

/* --- one file --- */

void wb_vtk_file_begin(struct wb_vtk_file *file)
{
    wb_text_append(&file->text, "<?xml version=\"1.0\"?>\n"
                                "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                                "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                                "  <UnstructuredGrid>\n");
}

void wb_vtk_file_end_head(struct wb_vtk_file *file)
{
    wb_text_append(&file->text, "      </Cells>\n"
                                "    </Piece>\n"
                                "  </UnstructuredGrid>\n"
                                "  <AppendedData encoding=\"raw\">\n"
                                "_");
}

void wb_vtk_file_declare(struct wb_vtk_file *file, const char *type, const char *name,
                         uint64_t size, const char *more)
{
    wb_text_append(&file->text,
                   "        <DataArray type=\"%s\" Name=\"%s\"%s format=\"appended\" "
                   "offset=\"%llu\"/>\n",
                   type, name, more, (unsigned long long)file->offset);
    file->offset += BLOCK_HEAD + size;
}

void wb_vtk_file_put_integer(struct wb_vtk_file *file, uint64_t value, int n_bytes)
{
    unsigned char bytes[8];
    for (int k = 0; k < n_bytes; k++)
        bytes[k] = (unsigned char)(value >> (8 * k));
    wb_text_append_bytes(&file->text, bytes, (size_t)n_bytes);
}

void wb_vtk_file_put_size(struct wb_vtk_file *file, uint64_t size)
{
    wb_vtk_file_put_integer(file, size, BLOCK_HEAD);
}

void wb_vtk_file_put_float(struct wb_vtk_file *file, double value)
{
    const float number = (float)value;
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    wb_vtk_file_put_integer(file, bits, 4);
}

void wb_vtk_file_put_double(struct wb_vtk_file *file, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    wb_vtk_file_put_integer(file, bits, 8);
}

static enum wb_status write_text(const char *path, struct wb_text *text)
{
    const enum wb_status status = text->failed ? wb_fail(WB_ERR_MEMORY, "no memory for %s", path)
                                               : wb_file_write(path, text->bytes, text->length);
    wb_text_release(text);
    return status;
}

enum wb_status wb_vtk_file_write(struct wb_vtk_file *file, const char *path)
{
    wb_text_append(&file->text, "\n  </AppendedData>\n</VTKFile>\n");
    return write_text(path, &file->text);
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
        return wb_fail(WB_ERR_ARGUMENT, "a state of a VTK series has no finite time");
    name_state(series, series->n, file);
    return wb_file_join(path, series->folder, file);
}

/* The .pvd file with the states so far. */
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
    if (series->states.failed)
        return wb_fail(WB_ERR_MEMORY, "no memory for the VTK series %s", series->name);
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
