/* A material file from tensile tests: fe/material/material_file.h, with origin and intervals. */
#ifndef WB_ANALYSIS_CALIBRATION_CONSTITUENTS_TENSILE_MATERIAL_H
#define WB_ANALYSIS_CALIBRATION_CONSTITUENTS_TENSILE_MATERIAL_H

#include "analysis/calibration/constituents/tensile.h"
#include "base/reason.h"
#include "base/setting.h"

/* Values that tensile tests do not give. 0: not given. */
struct wb_tensile_material_settings {
    double youngs_modulus; /* Pa; must be given where the elongation is a crosshead's */
    double density;        /* kg/m3; must be given */
    double poissons_ratio; /* 1 */
};
extern const struct wb_setting_table wb_tensile_material_table;

/* Writes the file: sigma_Y, K and n of the least squares on the specimens' mean curve, E of the
 * tests or as given. `name` NULL: that of wire and constituent. WB_ERR_DATA if a value is missing,
 * and for specimens without a fitted law. */
WB_MUST_CHECK enum wb_status
wb_tensile_material_write(const struct wb_tensile_result *result, const char *name,
                          const struct wb_tensile_material_settings *settings, const char *path,
                          struct wb_reason *why);

#endif
