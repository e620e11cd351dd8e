/* VTK's XML files with appended raw data, and series of them. fe/output/vtk.c and
 * fe/output/bundle_vtk.c define the contents of a state: each lists its arrays in a table.
 *
 * The XML head declares the arrays and their positions in the appended bytes. Numbers are
 * little-endian on any machine.
 */
#ifndef WB_FE_OUTPUT_VTK_FILE_H
#define WB_FE_OUTPUT_VTK_FILE_H

#include <stddef.h>

#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

enum {
    WB_VTK_FILE_NAME = 100 /* maximum length of a series' name, including the NUL */
};

/* --- one file --- */

enum wb_vtk_file_section {
    WB_VTK_FILE_STATE, /* data of the complete state */
    WB_VTK_FILE_POINTS,
    WB_VTK_FILE_CELLS,
    WB_VTK_FILE_POSITIONS,
    WB_VTK_FILE_TOPOLOGY, /* the cells' points, offsets and types */
    WB_VTK_FILE_SECTIONS  /* number of sections */
};

enum wb_vtk_file_type {
    WB_VTK_FILE_UINT8,
    WB_VTK_FILE_INT32,
    WB_VTK_FILE_FLOAT32,
    WB_VTK_FILE_FLOAT64
};

struct wb_vtk_file_array {
    enum wb_vtk_file_section section;
    enum wb_vtk_file_type type;
    const char *name;
    const char *more; /* further attributes, each preceded by a space; NULL: none */
    size_t count;     /* of its numbers */
    double (*value)(const void *state, size_t i); /* the number i */
};

/* Writes a state completely or not at all: its `n` arrays in the order of their sections.
 * WB_ERR_DATA if a value is not finite. */
WB_MUST_CHECK enum wb_status wb_vtk_file_write(const char *path, int n_points, int n_cells,
                                               const struct wb_vtk_file_array *arrays, size_t n,
                                               const void *state);

/* --- a series --- */

/* Files NAME-0000.vtu, NAME-0001.vtu ... and NAME.pvd in a folder. */
struct wb_vtk_file_series {
    char folder[WB_PATH];
    char name[WB_VTK_FILE_NAME];
    int n;                 /* states so far */
    struct wb_text states; /* their lines in the .pvd file */
};

/* Initialises a series; writes nothing yet. The folder must exist when states are added.
 * WB_ERR_ARGUMENT if the name is empty, too long or contains a slash. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_init(struct wb_vtk_file_series *series,
                                                     const char *folder, const char *name);
void wb_vtk_file_series_release(struct wb_vtk_file_series *series); /* accepts a zeroed one */

/* Path of the next state. WB_ERR_ARGUMENT if `time`, which ParaView displays, is not finite. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_path(const struct wb_vtk_file_series *series,
                                                     double time, char path[WB_PATH]);

/* Adds that state, which must have been written, to the series and writes the .pvd file, so that an
 * interrupted run leaves a readable series. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_count(struct wb_vtk_file_series *series,
                                                      double time);

/* Removes the states so far, for a run that starts again. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_restart(struct wb_vtk_file_series *series);

#endif
