/* What a first loading alone says of Ludwik's K and n: the misfit around its optimum.
 *
 * K and n stand for each other: what a larger exponent takes from the stress at small plastic
 * strains, a larger K gives back. So the misfit is a valley, and the data cannot tell apart what
 * lies on its floor. At each pair E, sigma_Y, the bow and the level are free, by the slopes at the
 * optimum; the misfit is then that of a run of the beam.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_VALLEY_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_VALLEY_H

#include "analysis/calibration/cycle/cycle_data.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"

enum {
    WB_VALLEY_NODES = 15 /* of each direction; odd */
};

/* Plastic strain, amidst those of a test, at which the stress of hardening is a number of its own.
 */
#define WB_VALLEY_PLASTIC_STRAIN 3e-3

struct wb_cycle_valley_node {
    double strength, exponent; /* K (Pa), n */
    double stress;             /* Pa: what hardening adds at that plastic strain */
    double misfit;             /* RMS over the largest force; NaN where there is no such law */
};

struct wb_cycle_valley {
    struct wb_material best; /* of the first loading alone */
    double best_misfit;
    double limit; /* misfit up to which an F-test of 95 % does not tell a pair from the best */
    double strength_low, strength_high; /* Pa, of the pairs within the limit */
    double exponent_low, exponent_high;
    /* Along n first; the other way goes along the stress that hardening adds. */
    struct wb_cycle_valley_node nodes[WB_VALLEY_NODES][WB_VALLEY_NODES];
};

/* On the loading of a specimen, from a law of Ludwik near by. WB_ERR_DATA where the loading does
 * not bound K and n at all; `why` receives the reason, NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_cycle_valley_find(struct wb_cycle_valley *valley,
                                                  const struct wb_cycle_data *data,
                                                  const struct wb_law *start,
                                                  struct wb_reason *why);

#endif
