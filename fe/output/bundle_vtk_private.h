/* Functions of fe/output/bundle_vtk.c that only tests use. */
#ifndef WB_FE_OUTPUT_BUNDLE_VTK_PRIVATE_H
#define WB_FE_OUTPUT_BUNDLE_VTK_PRIVATE_H

#include "fe/output/bundle_vtk.h"

/* Writes one state. WB_ERR_DATA if a value is not finite. `deflection` in m. */
WB_MUST_CHECK enum wb_status
wb_bundle_vtk_write(const char *path, const struct wb_bundle_fields *fields, double deflection);

#endif
