/* States of a bundle as files of VTK, which ParaView opens.
 *
 * A .vtu file is one state: an UnstructuredGrid of hexahedra (type 12, the wires) and
 * quadrilaterals (type 9, the tape) at their straight positions in mm. Of points: displacement_mm,
 * von_mises_MPa, plastic_strain (see fe/bundle_fields.h); of cells: wire, from 1, 0 is the tape; of
 * the state: deflection_mm. Numbers are Float32 and Int32, about 80 bytes a hexahedron. A .pvd file
 * is the series of states in time. Equal states give equal files, byte for byte.
 */
#ifndef WB_FE_BUNDLE_VTK_H
#define WB_FE_BUNDLE_VTK_H

#include "base/file.h"
#include "base/status.h"
#include "base/text.h"
#include "fe/bundle_fields.h"

enum {
    WB_BUNDLE_VTK_NAME = 100 /* longest name of a series, with the NUL */
};

/* Writes one state. WB_ERR_DATA when a value is not finite. `deflection` in m. */
WB_MUST_CHECK enum wb_status
wb_bundle_vtk_write(const char *path, const struct wb_bundle_fields *fields, double deflection);

/* Files NAME-0000.vtu, NAME-0001.vtu ... and NAME.pvd in a folder. */
struct wb_bundle_vtk {
    char folder[WB_PATH];
    char name[WB_BUNDLE_VTK_NAME];
    int n;                 /* states so far */
    struct wb_text states; /* their lines in the .pvd file */
};

/* Writes nothing yet; the folder must exist when states are added. WB_ERR_ARGUMENT when the name is
 * empty, too long or holds a slash. */
WB_MUST_CHECK enum wb_status wb_bundle_vtk_init(struct wb_bundle_vtk *series, const char *folder,
                                                const char *name);
void wb_bundle_vtk_release(struct wb_bundle_vtk *series); /* accepts a zeroed one */

/* Writes the next state and then the series up to it, so that a run that stops leaves a series
 * that can be read. `time` is what ParaView's clock shows. */
WB_MUST_CHECK enum wb_status wb_bundle_vtk_add(struct wb_bundle_vtk *series, double time,
                                               double deflection,
                                               const struct wb_bundle_fields *fields);

/* Removes the states so far: the run begins anew. */
WB_MUST_CHECK enum wb_status wb_bundle_vtk_restart(struct wb_bundle_vtk *series);

#endif
