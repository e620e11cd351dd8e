/* States of a harness for ParaView: tubes of the wires' diameters, with curvature, moment and
 * tension as fields, in a series over the steps (fe/output/vtk_file.h). */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_VTK_H
#define WB_ANALYSIS_HARNESS_HARNESS_VTK_H

#include "analysis/harness/harness_run.h"
#include "base/status.h"

/* Writes NAME-0000.vtu, the stress-free shape, a file for each frame and step, and NAME.pvd, whose
 * times are those of the shapes, into a folder that exists. */
WB_MUST_CHECK enum wb_status wb_harness_vtk_write(const struct wb_harness_result_set *set,
                                                  const char *folder);

#endif
