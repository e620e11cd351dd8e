/* VTK's XML files with appended raw data, and series of them. What a state holds is the matter of
 * fe/output/vtk.c and fe/output/bundle_vtk.c: each lists its arrays in a table.
 *
 * The XML head declares the arrays and tells where in the bytes behind it each of them begins.
 * Numbers stand least byte first on any machine.
 */
#ifndef WB_FE_OUTPUT_VTK_FILE_H
#define WB_FE_OUTPUT_VTK_FILE_H

#include <stddef.h>

#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

enum {
    WB_VTK_FILE_NAME = 100 /* longest name of a series, with the NUL */
};

/* --- one file --- */

enum wb_vtk_file_section {
    WB_VTK_FILE_STATE, /* of the state as a whole */
    WB_VTK_FILE_POINTS,
    WB_VTK_FILE_CELLS,
    WB_VTK_FILE_POSITIONS,
    WB_VTK_FILE_TOPOLOGY, /* of the cells: their points, ends and types */
    WB_VTK_FILE_SECTIONS  /* how many */
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
    const char *more; /* further attributes, with a blank before each; NULL: none */
    size_t count;     /* of its numbers */
    double (*value)(const void *state, size_t i); /* the number i */
};

/* Writes a state, whole or not at all: its `n` arrays in the order of their sections. WB_ERR_DATA
 * when a number is not finite. */
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

/* Writes nothing yet; the folder must exist when states are added. WB_ERR_ARGUMENT when the name is
 * empty, too long or holds a slash. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_init(struct wb_vtk_file_series *series,
                                                     const char *folder, const char *name);
void wb_vtk_file_series_release(struct wb_vtk_file_series *series); /* accepts a zeroed one */

/* Where the next state belongs. WB_ERR_ARGUMENT when `time`, which ParaView's clock will show, is
 * not finite. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_path(const struct wb_vtk_file_series *series,
                                                     double time, char path[WB_PATH]);

/* Counts that state, which is written, and writes the series up to it, so that a run that stops
 * leaves one that can be read. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_count(struct wb_vtk_file_series *series,
                                                      double time);

/* Removes the states so far, for a run that starts again. */
WB_MUST_CHECK enum wb_status wb_vtk_file_series_restart(struct wb_vtk_file_series *series);

#endif
