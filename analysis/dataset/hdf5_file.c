#include "analysis/dataset/hdf5_file.h"

#include <stdlib.h>

#include <hdf5.h>

#include "base/file.h"
#include "base/memory.h"

enum {
    CHUNK_ROWS = 16384,
    DEFLATE_LEVEL = 6,
    GROWTH = 1 << 20 /* bytes by which a file grows in memory */
};

/* Creates the type of UTF-8 strings of variable length. */
static hid_t make_text_type(void)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, H5T_VARIABLE) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0) {
        H5Tclose(type);
        return -1;
    }
    return type;
}

/* Adds a scalar attribute to an object. */
static bool put_attribute(hid_t object, const char *name, hid_t type, const void *value)
{
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const bool good = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
    H5Aclose(attribute);
    H5Sclose(space);
    return good;
}

static bool put_text_attribute(hid_t object, const char *name, const char *text)
{
    const hid_t type = make_text_type();
    const bool good = type >= 0 && put_attribute(object, name, type, &text);
    H5Tclose(type);
    return good;
}

/* Properties of an array in the file: compressed in chunks, except if it is empty, which HDF5
 * cannot chunk. */
static hid_t make_storage(hsize_t rows)
{
    const hid_t storage = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = rows < CHUNK_ROWS ? rows : CHUNK_ROWS;
    bool good = storage >= 0 && H5Pset_obj_track_times(storage, false) >= 0;
    if (rows > 0)
        good = good && H5Pset_chunk(storage, 1, &chunk) >= 0 && H5Pset_shuffle(storage) >= 0 &&
               H5Pset_deflate(storage, DEFLATE_LEVEL) >= 0;
    if (good)
        return storage;
    H5Pclose(storage);
    return -1;
}

static bool put_column(hid_t group, const struct wb_column *column, size_t n_rows)
{
    const enum wb_column_type kind = column->kind->type;
    const hsize_t rows = n_rows;
    const hid_t type = kind == WB_COLUMN_TEXT   ? make_text_type()
                       : kind == WB_COLUMN_REAL ? H5Tcopy(H5T_IEEE_F64LE)
                                                : H5Tcopy(H5T_STD_I64LE);
    const hid_t in_memory = kind == WB_COLUMN_TEXT   ? type
                            : kind == WB_COLUMN_REAL ? H5T_NATIVE_DOUBLE
                                                     : H5T_NATIVE_INT64;
    const hid_t space = H5Screate_simple(1, &rows, NULL), storage = make_storage(rows);
    const hid_t array =
        H5Dcreate2(group, column->kind->name, type, space, H5P_DEFAULT, storage, H5P_DEFAULT);
    bool good = array >= 0;
    if (good && rows > 0)
        good = H5Dwrite(array, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, column->reals) >= 0;
    good = good && put_text_attribute(array, "unit", column->kind->unit);
    H5Dclose(array);
    H5Pclose(storage);
    H5Sclose(space);
    H5Tclose(type);
    return good;
}

static bool put_table(hid_t file, const struct wb_columns *table)
{
    const hid_t storage = H5Pcreate(H5P_GROUP_CREATE);
    bool good = storage >= 0 && H5Pset_obj_track_times(storage, false) >= 0;
    const hid_t group =
        good ? H5Gcreate2(file, table->name, H5P_DEFAULT, storage, H5P_DEFAULT) : -1;
    good = group >= 0;
    for (int i = 0; i < table->n && good; i++)
        good = put_column(group, &table->items[i], table->n_rows);
    H5Gclose(group);
    H5Pclose(storage);
    return good;
}

/* Creates a file in memory; negative on failure. HDF5 must not write to the disk itself: after a
 * failed write, HDF5 1.10 tries again at the end of the process and crashes. */
static hid_t make_file(void)
{
    const hid_t storage = H5Pcreate(H5P_FILE_CREATE), access = H5Pcreate(H5P_FILE_ACCESS);
    hid_t file = -1;
    if (storage >= 0 && access >= 0 && H5Pset_obj_track_times(storage, false) >= 0 &&
        H5Pset_fapl_core(access, GROWTH, false) >= 0)
        file = H5Fcreate("tables", H5F_ACC_TRUNC, storage, access);
    H5Pclose(storage);
    H5Pclose(access);
    return file;
}

static bool put_all(hid_t file, const struct wb_columns *tables, int n, const char *source,
                    bool is_virtual)
{
    const int virtual_rig = is_virtual;
    bool good = put_text_attribute(file, "format", "wirebench tables 1") &&
                put_text_attribute(file, "source", source) &&
                put_attribute(file, "is_virtual", H5T_NATIVE_INT, &virtual_rig);
    for (int i = 0; i < n && good; i++)
        good = put_table(file, &tables[i]);
    return good && H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0;
}

/* The bytes of the file, to be released with free(); NULL on failure. */
static void *take_image(hid_t file, size_t *size)
{
    const ssize_t found = H5Fget_file_image(file, NULL, 0);
    void *const image = found > 0 ? wb_memory_new((size_t)found, 1) : NULL;
    if (image && H5Fget_file_image(file, image, (size_t)found) == found) {
        *size = (size_t)found;
        return image;
    }
    free(image);
    return NULL;
}

enum wb_status wb_hdf5_file_write(const char *path, const struct wb_columns *tables, int n,
                                  const char *source, bool is_virtual)
{
    /* The library must not print error messages of its own. */
    H5E_auto2_t print;
    void *context;
    H5Eget_auto2(H5E_DEFAULT, &print, &context);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    size_t size = 0;
    const hid_t file = make_file();
    void *const image =
        file >= 0 && put_all(file, tables, n, source, is_virtual) ? take_image(file, &size) : NULL;
    H5Fclose(file);
    H5Eset_auto2(H5E_DEFAULT, print, context);
    const enum wb_status status = wb_file_write(path, wb_memory_need(image), size);
    free(image);
    return status;
}
