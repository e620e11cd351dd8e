/* Stress fields of a solid as files of VTK, which ParaView opens.
 *
 * A .vtu file is one state: an UnstructuredGrid of quadratic hexahedra (type 25) at their reference
 * positions in mm. Of points: displacement_mm, stress_MPa (Cauchy, global frame: xx, yy, zz, xy,
 * yz, xz), von_mises_MPa, plastic_strain (equivalent); of cells: part. Each part has points of its
 * own at an interface, where stresses jump. A .pvd file is the series of states in time. Equal
 * states give equal files, byte for byte.
 */
#ifndef WB_FE_VTK_H
#define WB_FE_VTK_H

#include "base/file.h"
#include "base/status.h"
#include "base/text.h"
#include "fe/solid_mesh.h"
#include "fe/wire3d.h"

enum {
    WB_VTK_NAME = 100 /* longest name of a series, with the NUL */
};

/* Writes one state. WB_ERR_DATA when a value is not finite. */
WB_MUST_CHECK enum wb_status wb_vtk_write(const char *path, const struct wb_solid_mesh *mesh,
                                          const struct wb_wire3d_fields *fields);

/* Files NAME-0000.vtu, NAME-0001.vtu ... and NAME.pvd in a folder. */
struct wb_vtk_series {
    char folder[WB_PATH];
    char name[WB_VTK_NAME];
    int n;                 /* states so far */
    struct wb_text states; /* their lines in the .pvd file */
};

/* Writes nothing yet; the folder must exist when states are added. WB_ERR_ARGUMENT when the name is
 * empty, too long or holds a slash. */
WB_MUST_CHECK enum wb_status wb_vtk_series_init(struct wb_vtk_series *series, const char *folder,
                                                const char *name);
void wb_vtk_series_release(struct wb_vtk_series *series); /* accepts a zeroed one */

/* Writes the next state and then the series up to it, so that a run that stops leaves a series
 * that can be read. `time` is what ParaView's clock shows. */
WB_MUST_CHECK enum wb_status wb_vtk_series_add(struct wb_vtk_series *series, double time,
                                               const struct wb_solid_mesh *mesh,
                                               const struct wb_wire3d_fields *fields);

#endif
