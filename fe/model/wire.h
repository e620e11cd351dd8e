/* A wire: the product, as its YAML file in fixtures/wires (or any path) describes it.
 *
 *     name: type1
 *     conductor_diameter_mm: 0.70
 *     outer_diameter_mm: 1.10
 *     u_outer_diameter_mm: 0.01   # optional, standard uncertainty; u_density_percent as well
 *     density_g_cm3: 4.06
 *     properties:                 # optional; homogenised, over the outer diameter
 *       source: Table 3 of the paper
 *       youngs_modulus_MPa: 5021
 *       poissons_ratio: 0.39
 *       yield_stress_MPa: 3.90
 *       strength_coefficient_MPa: 3222
 *       hardening_exponent: 0.99
 *       law: {...}                # optional: parallel parts, a hardening rule; law_file.h
 */
#ifndef WB_FE_MODEL_WIRE_H
#define WB_FE_MODEL_WIRE_H

#include <stdbool.h>

#include "base/reason.h"
#include "fe/material/law.h"
#include "fe/material/material.h"

struct wb_wire {
    char name[64];
    double conductor_diameter; /* m */
    double outer_diameter;     /* m */
    double density;            /* kg/m3, homogenised over the outer diameter */
    /* Standard uncertainties of the last two, m and a part of the density; 0: not stated. */
    double outer_diameter_uncertainty, density_uncertainty;
    bool has_properties;         /* the file gave `properties` */
    char source[160];            /* where the properties come from */
    struct wb_material material; /* WB_HARDENING_ISOTROPIC_POWER when has_properties */
    struct wb_law law;           /* the same, unless the file has a law of its own beside it */
};

/* Reads a wire file, or the properties file that `wirebench calibrate -o` writes, whose conductor
 * diameter is 0: not known. Errors name file, line and key; they go to `why`, or to the log where
 * that is NULL. */
WB_MUST_CHECK enum wb_status wb_wire_read(const char *path, struct wb_wire *wire,
                                          struct wb_reason *why);

/* Parses a wire from YAML text (a recording's `meta`); `origin` stands for the file in errors,
 * which go to `why` as well. */
WB_MUST_CHECK enum wb_status wb_wire_parse(const char *text, const char *origin,
                                           struct wb_wire *wire, struct wb_reason *why);

/* Second moment of area of the full circle, pi d^4 / 64, m4. */
double wb_wire_second_moment(const struct wb_wire *wire);

/* Mass per length, rho pi d^2 / 4, kg/m. */
double wb_wire_mass_per_length(const struct wb_wire *wire);

/* Bounds of a cantilever's initial stiffness at its tip, 3 E I / L^3 in N/m, for a length in m.
 * With properties: a third to three times their stiffness. Without: from freely sliding copper
 * strands of 0.05 mm that fill one sixth of the wire's area or three quarters of its conductor's,
 * to a solid copper conductor in a jacket of 10 GPa. */
void wb_wire_stiffness_bounds(const struct wb_wire *wire, double length, double *lowest,
                              double *highest);

#endif
