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

/* Returns the result of a call. The file is made in memory, so that a call fails only for want of
 * memory, which ends the program. */
static hid_t need(hid_t result)
{
    if (result < 0)
        wb_memory_need(NULL);
    return result;
}

/* Creates the type of UTF-8 strings of variable length. */
static hid_t make_text_type(void)
{
    const hid_t type = need(H5Tcopy(H5T_C_S1));
    need(H5Tset_size(type, H5T_VARIABLE));
    need(H5Tset_cset(type, H5T_CSET_UTF8));
    return type;
}

/* Adds a scalar attribute to an object. */
static void put_attribute(hid_t object, const char *name, hid_t type, const void *value)
{
    const hid_t space = need(H5Screate(H5S_SCALAR));
    const hid_t attribute = need(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    need(H5Awrite(attribute, type, value));
    H5Aclose(attribute);
    H5Sclose(space);
}

static void put_text_attribute(hid_t object, const char *name, const char *text)
{
    const hid_t type = make_text_type();
    put_attribute(object, name, type, &text);
    H5Tclose(type);
}

/* Properties of a new object: the file keeps no time of it. */
static hid_t make_storage(hid_t kind)
{
    const hid_t storage = need(H5Pcreate(kind));
    need(H5Pset_obj_track_times(storage, false));
    return storage;
}

static void put_column(hid_t group, const struct wb_column *column, size_t n_rows)
{
    const enum wb_column_type kind = column->kind->type;
    const hsize_t rows = n_rows, chunk = rows < CHUNK_ROWS ? rows : CHUNK_ROWS;
    const hid_t type = kind == WB_COLUMN_TEXT   ? make_text_type()
                       : kind == WB_COLUMN_REAL ? need(H5Tcopy(H5T_IEEE_F64LE))
                                                : need(H5Tcopy(H5T_STD_I64LE));
    const hid_t in_memory = kind == WB_COLUMN_TEXT   ? type
                            : kind == WB_COLUMN_REAL ? H5T_NATIVE_DOUBLE
                                                     : H5T_NATIVE_INT64;
    const hid_t space = need(H5Screate_simple(1, &rows, NULL));
    const hid_t storage = make_storage(H5P_DATASET_CREATE);
    /* Compressed in chunks, except if it is empty, which HDF5 cannot chunk. */
    if (rows > 0) {
        need(H5Pset_chunk(storage, 1, &chunk));
        need(H5Pset_shuffle(storage));
        need(H5Pset_deflate(storage, DEFLATE_LEVEL));
    }
    const hid_t array =
        need(H5Dcreate2(group, column->kind->name, type, space, H5P_DEFAULT, storage, H5P_DEFAULT));
    if (rows > 0)
        need(H5Dwrite(array, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, column->reals));
    put_text_attribute(array, "unit", column->kind->unit);
    H5Dclose(array);
    H5Pclose(storage);
    H5Sclose(space);
    H5Tclose(type);
}

static void put_table(hid_t file, const struct wb_columns *table)
{
    const hid_t storage = make_storage(H5P_GROUP_CREATE);
    const hid_t group = need(H5Gcreate2(file, table->name, H5P_DEFAULT, storage, H5P_DEFAULT));
    for (int i = 0; i < table->n; i++)
        put_column(group, &table->items[i], table->n_rows);
    H5Gclose(group);
    H5Pclose(storage);
}

/* Creates a file in memory. HDF5 must not write to the disk itself: after a failed write, HDF5 1.10
 * tries again at the end of the process and crashes. */
static hid_t make_file(void)
{
    const hid_t storage = make_storage(H5P_FILE_CREATE), access = need(H5Pcreate(H5P_FILE_ACCESS));
    need(H5Pset_fapl_core(access, GROWTH, false));
    const hid_t file = need(H5Fcreate("tables", H5F_ACC_TRUNC, storage, access));
    H5Pclose(storage);
    H5Pclose(access);
    return file;
}

/* The bytes of a file with the tables, to be released with free(). */
static void *make_image(const struct wb_columns *tables, int n, const char *source, bool is_virtual,
                        size_t *size)
{
    const int virtual_rig = is_virtual;
    const hid_t file = make_file();
    put_text_attribute(file, "format", "wirebench tables 1");
    put_text_attribute(file, "source", source);
    put_attribute(file, "is_virtual", H5T_NATIVE_INT, &virtual_rig);
    for (int i = 0; i < n; i++)
        put_table(file, &tables[i]);
    need(H5Fflush(file, H5F_SCOPE_GLOBAL));
    *size = (size_t)need(H5Fget_file_image(file, NULL, 0));
    void *const image = wb_memory_new(*size, 1);
    need(H5Fget_file_image(file, image, *size));
    H5Fclose(file);
    return image;
}

enum wb_status wb_hdf5_file_write(const char *path, const struct wb_columns *tables, int n,
                                  const char *source, bool is_virtual)
{
    /* The library must not print error messages of its own. */
    H5E_auto2_t print;
    void *context;
    H5Eget_auto2(H5E_DEFAULT, &print, &context);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    size_t size;
    void *const image = make_image(tables, n, source, is_virtual, &size);
    H5Eset_auto2(H5E_DEFAULT, print, context);
    const enum wb_status status = wb_file_write(path, image, size);
    free(image);
    return status;
}
