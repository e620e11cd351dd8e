/* A wire from its constituents: conductor, solid or of strands, in a jacket.
 *
 * What is known of copper and PVC apart becomes the wire's bending by the flexural rule of
 * mixtures, (E I)_eff = (E I)_conductor + (E I)_jacket (eq. 8), by (nu A)_eff = (nu A)_conductor +
 * (nu A)_jacket (eq. 9), and beyond the elastic range by the moment of the composite section over
 * its curvature. Two limits of a stranded conductor enclose what its friction makes of it:
 *   - bonded: the section stays plane, its metal spread over the conductor's circle;
 *   - sliding: each strand bends about its own axis, without friction.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CONSTITUENTS_LAYERS_H
#define WB_ANALYSIS_CALIBRATION_CONSTITUENTS_LAYERS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/reason.h"
#include "base/setting.h"
#include "fe/material/material.h"

struct wb_layers {
    struct wb_material conductor, jacket; /* the jacket's only where there is one */
    double conductor_diameter;            /* m; of strands, their circle */
    double outer_diameter;                /* m; the conductor's where there is no jacket */
    int strands;                          /* 0: the conductor is solid */
    double strand_diameter;               /* m */
};

/* The numbers of the struct, but the materials', as settings. */
extern const struct wb_setting_table wb_layers_table;

/* Metal over the conductor's circle, 1 where it is solid; (E I)_eff of
 * eq. 8, N m2, bonded or with sliding strands; nu_eff of eq. 9 over metal and jacket. */
double wb_layers_fill(const struct wb_layers *layers);
double wb_layers_rigidity(const struct wb_layers *layers, bool sliding);
double wb_layers_poissons_ratio(const struct wb_layers *layers);

/* Moments of a first loading, N m, at n curvatures >= 0, 1/m. WB_ERR_ARGUMENT, with the reason in
 * `why` (or logged where that is NULL), for diameters out of order and strands that do not fit into
 * their circle: the numbers above say nothing then. */
WB_MUST_CHECK enum wb_status wb_layers_moments(const struct wb_layers *layers, bool sliding,
                                               const double *curvature, int n, double *moment,
                                               struct wb_reason *why);

#endif
