/* Calibrated properties as a file: PROPERTIES.yaml, written by calibrate, read by validate.
 *
 *     wire: type1
 *     outer_diameter_mm: 1.1
 *     mass_per_length_kg_m: 0.00386
 *     youngs_modulus_MPa: 5021
 *     yield_stress_MPa: 3.9
 *     strength_coefficient_MPa: 3222
 *     hardening_exponent: 0.99
 *     poissons_ratio: 0.39
 *     deviations: {...}           # standard uncertainties, as far as known
 *     calibration: {...}          # length, elastic zone, yield point, RMS, stop reason, datasets
 *                                 # with sha256, tool revision, whether on a virtual rig
 */
#ifndef WB_ANALYSIS_PROPERTIES_H
#define WB_ANALYSIS_PROPERTIES_H

#include <stdbool.h>

#include "analysis/calibrate.h"
#include "base/status.h"
#include "fe/material/law.h"

struct wb_properties {
    char wire[64];
    double outer_diameter;  /* m */
    double mass_per_length; /* kg/m */
    struct wb_material material;
    struct wb_law law;         /* the same, unless the properties have a law of their own */
    double largest_curvature;  /* 1/m, up to which the law is known; NaN unknown */
    double deviation[4];       /* of E, sigma_Y, ln K, n in SI; NaN unknown */
    double calibration_length; /* m; NaN when not from calibrate */
    double rms;                /* of the calibration, 1; NaN unknown */
    double scatter_rms,
        residual_scatter_rms;   /* of the calibration's samples, over F_max (a follower
                                   test's largest deflection), 1; NaN unknown */
    double stiffness_deviation; /* standard deviation of ln(EI) over the calibration's samples; NaN
                                   unknown */
    int n_samples;              /* of the calibration; 0 unknown */
    bool is_virtual;
};

/* Reads a properties file; errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_properties_read(const char *path, struct wb_properties *properties);
/* `names` are the datasets' folders as given. WB_ERR_EXISTS unless `force`. */
WB_MUST_CHECK enum wb_status wb_properties_write(const char *path,
                                                 const struct wb_calibrate_result *result,
                                                 const struct wb_calibrate_settings *settings,
                                                 const char *const *names, int n_names, bool force);
/* The same properties without a file in between. */
void wb_properties_from_result(const struct wb_calibrate_result *result,
                               struct wb_properties *properties);

#endif
