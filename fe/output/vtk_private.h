/* Functions of fe/output/vtk.c that only tests use. */
#ifndef WB_FE_OUTPUT_VTK_PRIVATE_H
#define WB_FE_OUTPUT_VTK_PRIVATE_H

#include "fe/output/vtk.h"

/* Writes one state. WB_ERR_DATA if a value is not finite. */
WB_MUST_CHECK enum wb_status wb_vtk_write(const char *path, const struct wb_solid_mesh *mesh,
                                          const struct wb_wire3d_fields *fields);

#endif
