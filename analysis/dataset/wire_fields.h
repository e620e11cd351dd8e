/* Stress fields of a computed wire on the sections of its model: the longitudinal section, and the
 * cross sections of `fields_at_mm`. Of cross sections in the same plane of the mesh only one is
 * kept. */
#ifndef WB_ANALYSIS_DATASET_WIRE_FIELDS_H
#define WB_ANALYSIS_DATASET_WIRE_FIELDS_H

#include "analysis/dataset/fields.h"
#include "base/status.h"
#include "fe/model/wire_model.h"
#include "fe/solid/solid_mesh.h"
#include "fe/trial/wire1d.h"
#include "fe/trial/wire3d.h"

/* Appends the fields of the current state of a 3D wire. The axial stress is that along the deformed
 * axis at the same place of the straight wire. */
WB_MUST_CHECK enum wb_status
wb_wire_fields_solid(struct wb_fields *fields, const struct wb_wire_model *model, const char *state,
                     const struct wb_solid_mesh *mesh, const struct wb_wire3d_fields *solid);

/* The same for a 1D wire: cells of fibres with uniform stress; the longitudinal section has
 * `n_slices` along the wire. The von Mises stress is that of axial stress and torsion. */
WB_MUST_CHECK enum wb_status wb_wire_fields_rod(struct wb_fields *fields,
                                                const struct wb_wire_model *model,
                                                const char *state, const struct wb_wire1d *rod,
                                                int n_slices);

#endif
