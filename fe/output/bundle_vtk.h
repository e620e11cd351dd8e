/* States of a bundle as VTK files, for ParaView.
 *
 * A .vtu file is one state: an UnstructuredGrid of hexahedra (type 12, the wires) and
 * quadrilaterals (type 9, the tape) at their straight positions in mm. Point data: displacement_mm,
 * von_mises_MPa, plastic_strain (see fe/output/bundle_fields.h); cell data: wire, from 1, 0 is the
 * tape; field data: deflection_mm. Numbers are Float32 and Int32, about 80 bytes per hexahedron. A
 * .pvd file lists the states of a series over time. Equal states give identical files.
 */
#ifndef WB_FE_OUTPUT_BUNDLE_VTK_H
#define WB_FE_OUTPUT_BUNDLE_VTK_H

#include "base/status.h"
#include "fe/output/bundle_fields.h"
#include "fe/output/vtk_file.h"

/* Writes the next state of a series, and updates the .pvd file. */
WB_MUST_CHECK enum wb_status wb_bundle_vtk_add(struct wb_vtk_file_series *series, double time,
                                               double deflection,
                                               const struct wb_bundle_fields *fields);

#endif
