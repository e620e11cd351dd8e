/* VTK's XML files with appended raw data, and series of them. What a state holds is the matter of
 * fe/output/vtk.c and fe/output/bundle_vtk.c.
 *
 * The XML head tells where in the bytes behind it each array begins, so arrays are declared first
 * and put in the same order after. Numbers stand least byte first on any machine.
 */
#ifndef WB_FE_OUTPUT_VTK_FILE_H
#define WB_FE_OUTPUT_VTK_FILE_H

#include <stdint.h>

#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

enum {
    WB_VTK_FILE_NAME = 100 /* longest name of a series, with the NUL */
};

/* --- one file --- */

/* All zero at first; wb_vtk_file_write() releases it. */
struct wb_vtk_file {
    struct wb_text text;
    uint64_t offset; /* of the next array that is declared */
};

/* Text up to the grid's first element, and from the cells' end to where the arrays begin. */
void wb_vtk_file_begin(struct wb_vtk_file *file);
void wb_vtk_file_end_head(struct wb_vtk_file *file);

/* Declares an array of `size` bytes; `more` are further attributes, with a blank before each. */
void wb_vtk_file_declare(struct wb_vtk_file *file, const char *type, const char *name,
                         uint64_t size, const char *more);

/* What the array begins with, then its numbers. */
void wb_vtk_file_put_size(struct wb_vtk_file *file, uint64_t size);
void wb_vtk_file_put_integer(struct wb_vtk_file *file, uint64_t value, int n_bytes);
void wb_vtk_file_put_float(struct wb_vtk_file *file, double value);
void wb_vtk_file_put_double(struct wb_vtk_file *file, double value);

/* Ends the file and writes it, whole or not at all. */
WB_MUST_CHECK enum wb_status wb_vtk_file_write(struct wb_vtk_file *file, const char *path);

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
