/* Tables as an HDF5 file, which MATLAB, Octave, Python, R and Julia read.
 *
 * Each table is a group with one array per column; a column has the attribute `unit`. The file has
 * the attributes `source`, the origin of the data, and `format`. Reals are doubles, integers signed
 * with 64 bits, texts UTF-8 of variable length. Arrays are compressed with deflate. The same tables
 * give the same bytes: no time is stored.
 *
 * HDF5 was preferred to MAT files because of integers of 64 bits, units as attributes and texts of
 * any length. */
#ifndef WB_ANALYSIS_DATASET_HDF5_FILE_H
#define WB_ANALYSIS_DATASET_HDF5_FILE_H

#include "base/columns.h"
#include "base/status.h"

/* Writes n tables. The file is replaced atomically. WB_ERR_IO if it cannot be written.
 * `is_virtual` sets an attribute of that name to 1: the data come from the virtual rig. */
WB_MUST_CHECK enum wb_status wb_hdf5_file_write(const char *path, const struct wb_columns *tables,
                                                int n, const char *source, bool is_virtual);

#endif
