/* A material as its YAML file in fixtures/materials (or any path) describes it.
 *
 *     name: annealed-copper
 *     substitute: true                  # optional: stands in for values that are lost
 *     source: where the values come from
 *     origin: tensile tests             # optional: kind of source, in a few words
 *     youngs_modulus_MPa: 68200
 *     poissons_ratio: 0.34              # optional
 *     yield_stress_MPa: 182             # optional; absent: linear elastic
 *     hardening: isotropic              # optional; or kinematic (linear, no exponent)
 *     strength_coefficient_MPa: 292     # optional, with the exponent; absent: perfectly plastic
 *     hardening_exponent: 0.31
 *     density_g_cm3: 8.96
 *     thickness_of_two_layers_mm: 0.2   # tapes only
 *     intervals:                        # optional: what values of these keys may be as well
 *       youngs_modulus_MPa: [67500, 68360]
 */
#ifndef WB_FE_MATERIAL_MATERIAL_FILE_H
#define WB_FE_MATERIAL_MATERIAL_FILE_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material/material.h"

/* Numbers that may have an interval. */
enum wb_material_number {
    WB_MATERIAL_MODULUS,
    WB_MATERIAL_YIELD,
    WB_MATERIAL_STRENGTH,
    WB_MATERIAL_EXPONENT,
    WB_MATERIAL_NUMBERS
};

struct wb_material_file {
    char name[64];
    char source[400];
    char origin[64]; /* "": not given */
    /* Least and most of E, sigma_Y, K (Pa) and n; NaN: not given. */
    double interval[WB_MATERIAL_NUMBERS][2];
    bool is_substitute;
    struct wb_material material; /* poissons_ratio is NaN when not given; without a yield stress
                                    WB_HARDENING_NONE_ELASTIC */
    double density;              /* kg/m3 */
    double thickness;            /* m, of two layers of a tape; 0: not a tape */
};

/* Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_material_file_read(struct wb_material_file *file, const char *path);

#endif
