/* States of a bundle as files of VTK, which ParaView opens.
 *
 * A .vtu file is one state: an UnstructuredGrid of hexahedra (type 12, the wires) and
 * quadrilaterals (type 9, the tape) at their straight positions in mm. Of points: displacement_mm,
 * von_mises_MPa, plastic_strain (see fe/output/bundle_fields.h); of cells: wire, from 1, 0 is the
 * tape; of the state: deflection_mm. Numbers are Float32 and Int32, about 80 bytes a hexahedron. A
 * .pvd file is the series of states in time. Equal states give equal files, byte for byte.
 */
#ifndef WB_FE_OUTPUT_BUNDLE_VTK_H
#define WB_FE_OUTPUT_BUNDLE_VTK_H

#include "base/status.h"
#include "fe/output/bundle_fields.h"
#include "fe/output/vtk_file.h"

/* Writes the next state of a series, and the series up to it. */
WB_MUST_CHECK enum wb_status wb_bundle_vtk_add(struct wb_vtk_file_series *series, double time,
                                               double deflection,
                                               const struct wb_bundle_fields *fields);

#endif
