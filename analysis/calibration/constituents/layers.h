/* Bending of a wire from its constituents: conductor, solid or stranded, in a jacket.
 *
 * The properties of copper and PVC give the wire's bending by the flexural rule of mixtures, (E
 * I)_eff = (E I)_conductor + (E I)_jacket (eq. 8), by (nu A)_eff = (nu A)_conductor + (nu A)_jacket
 * (eq. 9), and beyond the elastic range by the moment of the composite section over its curvature.
 * The friction of a stranded conductor lies between two limits:
 *   - bonded: the section stays plane, with its metal spread over the conductor's circle;
 *   - sliding: each strand bends about its own axis, without friction.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CONSTITUENTS_LAYERS_H
#define WB_ANALYSIS_CALIBRATION_CONSTITUENTS_LAYERS_H

#include <stdbool.h>

#include "base/reason.h"
#include "base/setting.h"
#include "fe/material/material.h"

struct wb_layers {
    struct wb_material conductor, jacket; /* the jacket's is used only if there is a jacket */
    double conductor_diameter;            /* m; of strands, their circle */
    double outer_diameter;                /* m; the conductor's if there is no jacket */
    int strands;                          /* 0: the conductor is solid */
    double strand_diameter;               /* m */
};

/* Settings for the members of the struct except the materials. */
extern const struct wb_setting_table wb_layers_table;

/* Fill factor of metal in the conductor's circle, 1 if it is solid; (E I)_eff of eq. 8, N m2,
 * bonded or with sliding strands; nu_eff of eq. 9 over metal and jacket. */
double wb_layers_fill(const struct wb_layers *layers);
double wb_layers_rigidity(const struct wb_layers *layers, bool sliding);
double wb_layers_poissons_ratio(const struct wb_layers *layers);

/* Moments of a first loading, N m, at n curvatures >= 0, 1/m. WB_ERR_ARGUMENT for inconsistent
 * diameters and for strands that do not fit into their circle, for which the functions above are
 * meaningless too; `why` receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_layers_moments(const struct wb_layers *layers, bool sliding,
                                               const double *curvature, int n, double *moment,
                                               struct wb_reason *why);

#endif
