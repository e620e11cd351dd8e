/* Ludwik's K and n from a first loading alone: the misfit around its optimum.
 *
 * K and n are strongly correlated: a larger K compensates the smaller stress of a larger exponent
 * at small plastic strains. The misfit has a valley, along which the data cannot distinguish pairs
 * of K and n. At each pair, E, sigma_Y, the bow and the level follow from the Jacobian at the
 * optimum; the misfit is then computed by a run of the beam.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_VALLEY_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_VALLEY_H

#include "analysis/calibration/cycle/cycle_data.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"

enum {
    WB_VALLEY_NODES = 15 /* in each direction; odd */
};

struct wb_cycle_valley_node {
    double exponent;
    double stress; /* Pa: hardening stress at WB_BENDING_PLASTIC_STRAIN */
    double misfit; /* RMS over the largest force; NaN: no such law, or not computed */
};

struct wb_cycle_valley {
    struct wb_material best; /* of the first loading alone */
    double best_misfit;
    double limit; /* misfit up to which an F-test at 95 % does not reject a pair against the best */
    double strength_low, strength_high; /* Pa, of the pairs within the limit */
    double exponent_low, exponent_high;
    /* The first index is along n, the second along the hardening stress. */
    struct wb_cycle_valley_node nodes[WB_VALLEY_NODES][WB_VALLEY_NODES];
};

/* Finds the valley of the loading of a specimen, from a Ludwik law as the initial guess.
 * WB_ERR_DATA if the loading does not bound K and n; `why` receives the reason, NULL: it is logged.
 */
WB_MUST_CHECK enum wb_status wb_cycle_valley_find(struct wb_cycle_valley *valley,
                                                  const struct wb_cycle_data *data,
                                                  const struct wb_law *start,
                                                  struct wb_reason *why);

#endif
