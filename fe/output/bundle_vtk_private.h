/* What tests of fe/output/bundle_vtk.h ask beside it. */
#ifndef WB_FE_OUTPUT_BUNDLE_VTK_PRIVATE_H
#define WB_FE_OUTPUT_BUNDLE_VTK_PRIVATE_H

#include "fe/output/bundle_vtk.h"

/* Writes one state. WB_ERR_DATA when a value is not finite. `deflection` in m. */
WB_MUST_CHECK enum wb_status
wb_bundle_vtk_write(const char *path, const struct wb_bundle_fields *fields, double deflection);

#endif
