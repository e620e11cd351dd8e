/* Stress fields of a solid as VTK files, for ParaView.
 *
 * A .vtu file is one state: an UnstructuredGrid of quadratic hexahedra (type 25) at their reference
 * positions in mm. Point data: displacement_mm, stress_MPa (Cauchy, global frame: xx, yy, zz, xy,
 * yz, xz), von_mises_MPa, plastic_strain (equivalent); cell data: part. Each part has its own
 * points at an interface, where stresses are discontinuous. A .pvd file lists the states of a
 * series over time. Equal states give identical files.
 */
#ifndef WB_FE_OUTPUT_VTK_H
#define WB_FE_OUTPUT_VTK_H

#include "base/status.h"
#include "fe/output/vtk_file.h"
#include "fe/solid/solid_mesh.h"
#include "fe/trial/wire3d.h"

/* Writes the next state of a series, and updates the .pvd file. */
WB_MUST_CHECK enum wb_status wb_vtk_add(struct wb_vtk_file_series *series, double time,
                                        const struct wb_solid_mesh *mesh,
                                        const struct wb_wire3d_fields *fields);

#endif
