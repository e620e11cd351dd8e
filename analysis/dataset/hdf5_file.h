/* Tables as an HDF5 file: for MATLAB, Octave, Python, R and Julia, which all read it.
 *
 * Each table is a group with one array per column; a column has the attribute `unit`. The file has
 * the attributes `source`, what it comes from, and `format`. Reals are doubles, integers signed of
 * 64 bits, texts UTF-8 of variable length. Arrays are compressed with deflate. The same tables give
 * the same bytes: no time is stored.
 *
 * HDF5 rather than MAT files: integers of 64 bits, units as attributes, and texts of any length;
 * and MATLAB reads it.
 */
#ifndef WB_ANALYSIS_DATASET_HDF5_FILE_H
#define WB_ANALYSIS_DATASET_HDF5_FILE_H

#include "base/columns.h"
#include "base/status.h"

/* Writes n tables. The file appears whole or not at all; an existing one is replaced. WB_ERR_IO
 * where it cannot be written. `is_virtual` sets an attribute of that name to 1: the data come from
 * the virtual rig. */
WB_MUST_CHECK enum wb_status wb_hdf5_file_write(const char *path, const struct wb_columns *tables,
                                                int n, const char *source, bool is_virtual);

#endif
